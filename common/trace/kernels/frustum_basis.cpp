#include <cmath>

#include "common/trace/kernels/tile_kernels.h"

namespace mdk {
namespace {

FrustumBasis make_basis(const Vec3d& origin, const Vec3d& corner, const Vec3d& du,
                        const Vec3d& dv) {
  FrustumBasis basis;
  basis.origin = origin;
  basis.corner_x_dv = cross(corner, dv);
  basis.du_x_corner = cross(du, corner);
  basis.du_x_dv = cross(du, dv);
  basis.det = dot(corner, basis.du_x_dv);

  // The products cancel where a map is near singular; what is lost is relative to their factors.
  constexpr double kRounding = 0x1p-46;
  const double c = length(corner), u = length(du), v = length(dv);
  basis.plane_error = kRounding * (c * (u + v) + kMaxImageSide * u * v);
  const double det = std::abs(basis.det);
  basis.depth_error = kRounding * (u * v + length(basis.du_x_dv) / det * c * u * v) / det;
  return basis;
}

}  // namespace

FrustumBasis make_frustum_basis(const PinholeRays& rays) {
  return make_basis(to_double(rays.origin), to_double(rays.corner), to_double(rays.du),
                    to_double(rays.dv));
}

FrustumBasis make_frustum_basis(const PinholeRays& rays, const Affine3d& local_from_world) {
  return make_basis(local_from_world.point(to_double(rays.origin)),
                    local_from_world.vector(to_double(rays.corner)),
                    local_from_world.vector(to_double(rays.du)),
                    local_from_world.vector(to_double(rays.dv)));
}

PixelFromWorld make_pixel_from_world(const PinholeRays& rays) {
  // The inverse of the matrix with columns (du, dv, corner).
  const Vec3d corner = to_double(rays.corner), du = to_double(rays.du), dv = to_double(rays.dv);
  const Vec3d rows[3] = {cross(dv, corner), cross(corner, du), cross(du, dv)};
  const double det = dot(corner, rows[2]);
  PixelFromWorld result;
  result.origin = rays.origin;
  for (int i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) result.m[i][j] = static_cast<float>(rows[i][j] / det);
  return result;
}

void TileScratch::begin_tile(std::size_t triangles, std::size_t clusters) {
  triangle_stamps.resize(triangles, 0);
  cluster_stamps.resize(clusters, 0);
  if (++serial == 0) {  // wrapped round: old stamps would look new
    triangle_stamps.assign(triangles, 0);
    cluster_stamps.assign(clusters, 0);
    serial = 1;
  }
}

}  // namespace mdk
