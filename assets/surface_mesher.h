// A first, closed mesh of a distance field's zero surface, by marching tetrahedra.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "assets/distance_field.h"
#include "common/math/aabb.h"

namespace mdk {

struct TriangleMesh {
  std::vector<Vec3d> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< counter-clockwise from outside
};

/// The surface where `field` is 0 within `box`, sampled on cubes of side `cell`. The solid must lie
/// inside the box; then the mesh is a closed 2-manifold, however thin its parts, because every
/// tetrahedron is cut by at most one plane. Triangles are uneven: remesh before use.
/// Cost: one field evaluation per grid point.
TriangleMesh mesh_surface(const DistanceField& field, const Aabbd& box, double cell);

}  // namespace mdk
