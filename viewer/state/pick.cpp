#include "viewer/state/pick.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/trace/brute_force.h"

namespace mdk {
namespace {

std::array<Vec3d, 3> local_corners(const ModelView& model, std::uint32_t key, std::uint32_t cluster,
                                   const Triangle& triangle) {
  const Affine3d local_from_world = to_double(model.key_maps(key)[cluster]);
  std::array<Vec3d, 3> corners;
  for (std::size_t i = 0; i < 3; ++i) {
    Vec3f corner;
    decode_pose(model, key, {triangle.v[i], triangle.v[i] + 1}, {&corner, 1});
    corners[i] = local_from_world.point(to_double(corner));
  }
  return corners;
}

}  // namespace

std::uint32_t cluster_of_triangle(const ModelView& model, std::uint32_t triangle) {
  const auto after = std::upper_bound(
      model.clusters.begin(), model.clusters.end(), triangle,
      [](std::uint32_t t, const Cluster& cluster) { return t < cluster.first_triangle; });
  // Of clusters that start at one place, the last is the one that is not empty.
  return static_cast<std::uint32_t>(after - model.clusters.begin()) - 1;
}

std::optional<PickedTriangle> pick_triangle(const ModelView& model, const Moment& moment,
                                            const PictureRays& picture, std::uint32_t x,
                                            std::uint32_t y) {
  const PinholeRays rays = make_pinhole_rays(picture.camera, picture.width, picture.height);
  const QueryRay ray{rays.origin,
                     rays.direction(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f)};
  const QueryHit hit = brute_force_closest_hit(mesh_at(model, moment), ray);
  if (!hit.is_hit()) return {};
  return PickedTriangle{hit.triangle, cluster_of_triangle(model, hit.triangle), hit.t};
}

ResidualCurve residual_curve(const ModelView& model, std::uint32_t clip, std::uint32_t triangle) {
  const std::uint32_t cluster = cluster_of_triangle(model, triangle);
  const Triangle& corners = model.triangles[triangle];
  const auto at_rest = local_corners(model, model.rest_key, cluster, corners);
  const Affine3d map = to_double(model.key_maps(model.rest_key)[cluster]);
  const double unit = std::cbrt(std::abs(map.determinant())) * model.rest_diagonal;
  ResidualCurve curve;
  const Clip& shown = model.clips[clip];
  for (std::uint32_t key = shown.first_key; key < shown.first_key + shown.key_count; ++key) {
    const auto now = local_corners(model, key, cluster, corners);
    double largest = 0;
    for (std::size_t i = 0; i < 3; ++i) largest = std::max(largest, length(now[i] - at_rest[i]));
    curve.seconds.push_back(model.key_times[key]);
    curve.residuals.push_back(unit > 0 ? largest / unit : 0);
  }
  return curve;
}

const ResidualCurve& ResidualCurveCache::curve(const ModelView& model, std::uint32_t clip,
                                               std::uint32_t triangle) {
  if (curve_.seconds.empty() || clip != clip_ || triangle != triangle_)
    curve_ = residual_curve(model, clip, triangle);
  clip_ = clip;
  triangle_ = triangle;
  return curve_;
}

}  // namespace mdk
