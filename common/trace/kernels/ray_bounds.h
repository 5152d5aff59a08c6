// What bounds a frame's rays in one basis (the world, or a cluster's), made once per frame and
// basis: a tile or a beam then has its own bounds there with a few operations.
#pragma once

#include "common/math/aabb.h"
#include "common/math/affine3.h"
#include "common/trace/camera.h"

namespace mdk {

inline constexpr int kSides = 4;

/// Forms f(p) = n.p + w of a frame's tiles, in float, for boxes inside the bounds they were made
/// for (docs/kernels.md, "Frusta").
struct FrustumForms {
  /// A tile's four sides: nx of all, ny of all, nz of all, w of all, each base + step * place, with
  /// places left x, right x, upper y, lower y in pixels. Negative on the outer side.
  alignas(64) float base[4 * kSides];
  alignas(64) float step[4 * kSides];
  /// No point of a box is nearer than the smallest depth.p + depth_offset over its corners.
  Vec3f depth;
  float depth_offset;
  /// Nothing in the bounds is behind the eye, so nothing need be tested against it.
  bool in_front;
  float front_offset;  ///< a box is behind the eye if depth.p + front_offset < 0 at all corners
  Vec3f eye;
};

/// For boxes inside `bounds`, in the basis that `local_from_world` maps to. Every offset includes a
/// slack that covers the rounding of the forms, of their values over boxes, and of the triangle
/// test, so that no box that holds part of a hit triangle is ever dropped. Forms of a basis too
/// near singular to tell anything are zero. Places of tiles may be as far as `before` below 0.
FrustumForms make_frustum_forms(const PinholeRays& world_rays, const Affine3d& local_from_world,
                                const Aabb& bounds, double before = 0);

/// Makes forms hold for boxes that are off by at most `distance` along each axis.
void loosen(FrustumForms& forms, float distance);

/// How forms over the world read in a basis, for boxes inside its bounds. A plane's normal n
/// becomes cofactor n, so no map need be inverted: near singular ones only cull less.
struct BeamSpace {
  Vec3d cofactor[3];       ///< columns: (cofactor n) . q = det (n . p) for q the image of p
  double det = 1;          ///< of the linear part, its size
  double rounding = 0;     ///< bounds what the cofactors' columns may have lost, per component
  Vec3d reach;             ///< of local coordinates from 0
  double world_reach = 0;  ///< of the mesh from a beam's origin, summed over axes
};

/// A cluster's basis, or the world's, for boxes inside `bounds`. `mesh` holds all that beams start
/// from and may hit.
BeamSpace make_beam_space(const Affine3d& local_from_world, const Aabb& bounds, const Aabb& mesh);

}  // namespace mdk
