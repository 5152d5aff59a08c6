// What bounds the tiles of one frame in one basis (the world, or a cluster's): linear forms whose
// coefficients are linear in the tile's place, so that a tile has its frustum with one vector
// operation.
#pragma once

#include "common/math/aabb.h"
#include "common/math/affine3.h"
#include "common/trace/camera.h"

namespace mdk {

/// The products of the pinhole's vectors that all bounds of a frame are made of, in double. See
/// docs/kernels.md, "Frusta".
struct FrustumBasis {
  Vec3d origin;
  Vec3d corner_x_dv, du_x_corner, du_x_dv;  ///< cross products
  double det = 0;          ///< of (corner, du, dv); its sign tells a mirrored basis
  double plane_error = 0;  ///< bounds the rounding of a side plane's normal, per component
  double depth_error = 0;  ///< the same for the gradient of the depth
};

FrustumBasis make_frustum_basis(const PinholeRays& world_rays);
FrustumBasis make_frustum_basis(const PinholeRays& world_rays, const Affine3d& local_from_world);

inline constexpr int kSides = 4;

/// Forms f(p) = n.p + w, in float, for boxes inside the bounds they were made for.
struct FrustumForms {
  /// A tile's four sides: nx of all, ny of all, nz of all, w of all, each base + step * place, with
  /// places left x, right x, upper y, lower y in pixels. Negative on the outer side.
  alignas(64) float base[4 * kSides];
  alignas(64) float step[4 * kSides];
  /// No point of a box is nearer than the least depth.p + depth_offset over its corners.
  Vec3f depth;
  float depth_offset;
  /// Nothing in the bounds is behind the eye, so nothing need be tested against it.
  bool in_front;
  float front_offset;  ///< a box is behind the eye if depth.p + front_offset < 0 at all corners
  Vec3f eye;
};

/// Every offset includes a slack that covers the rounding of the forms, of their values over boxes
/// inside `bounds`, and of the triangle test, so that no box that holds part of a hit triangle is
/// ever dropped. Forms of a basis too near singular to tell anything are zero.
FrustumForms make_frustum_forms(const FrustumBasis& basis, const Aabb& bounds);

}  // namespace mdk
