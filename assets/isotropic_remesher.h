// Turns a closed mesh of a distance field into one of even, nearly equilateral triangles.
#pragma once

#include "assets/distance_field.h"
#include "assets/surface_mesher.h"

namespace mdk {

struct RemeshOptions {
  std::function<double(const Vec3d&)> edge_length;  ///< wanted at a point; > 0, slowly varying
  DistanceField seam;  ///< edges should follow its zero line, where colours meet; may be empty
  int rounds = 10;
  double gradient_step = 0.01;  ///< for projecting onto the surface
};

/// Splits long edges, collapses short ones, flips edges towards six triangles at a vertex and
/// slides vertices within the surface, round after round (Botsch and Kobbelt 2004). `mesh` must be
/// a closed 2-manifold near the zero surface of `field`; so is the result, with its vertices on
/// that surface.
TriangleMesh remesh(TriangleMesh mesh, const DistanceField& field, const RemeshOptions& options);

/// `p` moved along the gradient onto the zero surface of `field`, from not too far away.
Vec3d project_to_surface(const DistanceField& field, Vec3d p, double gradient_step);

}  // namespace mdk
