#include "common/trace/heat_map.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "common/base/parallel.h"
#include "common/trace/color.h"
#include "common/trace/hit_buffer.h"

namespace mdk {

Vec3f heat_color(double share) {
  // sRGB; lightness rises in equal steps, hue turns from violet to yellow.
  static constexpr std::uint8_t kStops[][3] = {{64, 10, 88},   {66, 60, 132},  {44, 106, 142},
                                               {32, 148, 139}, {72, 187, 112}, {160, 216, 62},
                                               {250, 232, 56}};
  constexpr int kLast = static_cast<int>(std::size(kStops)) - 1;
  const double place = (share > 0 ? std::min(share, 1.0) : 0.0) * kLast;
  const int below = std::min(static_cast<int>(place), kLast - 1);
  const auto part = static_cast<float>(place - below);
  Vec3f color;
  for (std::size_t k = 0; k < 3; ++k)
    color[k] = linear_from_srgb(kStops[below][k]) * (1 - part) +
               linear_from_srgb(kStops[below + 1][k]) * part;
  return color;
}

double round_scale(double value) {
  if (!(value > 0) || !std::isfinite(value)) return 1;
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (const double step : {1.0, 2.0, 5.0})
    if (value <= step * power * (1 + 1e-9)) return step * power;
  return 10 * power;
}

void triangle_residuals(const PosedMesh& mesh, std::span<float> out) {
  const ModelView& model = mesh.model();
  PosedMesh rest(model);
  rest.set_time(at_key(model.rest_key));
  parallel_chunks(model.cluster_count(), 1, [&](std::size_t c, std::size_t) {
    const auto number = static_cast<std::uint32_t>(c);
    const Affine3d at_rest = rest.cluster_map(number), now = mesh.cluster_map(number);
    // A basis may be stretched against the world; at rest it should not be, and counts as 1.
    const double unit = std::cbrt(std::abs(at_rest.determinant())) * model.rest_diagonal;
    const Cluster& cluster = model.clusters[c];
    for (std::uint32_t t = cluster.first_triangle;
         t < cluster.first_triangle + cluster.triangle_count; ++t) {
      double largest = 0;
      for (const std::uint32_t v : model.triangles[t].v)
        largest = std::max(largest, length(now.point(to_double(mesh.positions()[v])) -
                                           at_rest.point(to_double(rest.positions()[v]))));
      out[t] = unit > 0 ? static_cast<float>(largest / unit) : 0.0f;
    }
  });
}

HeatMap::HeatMap() {
  constexpr std::uint32_t kColors = 256;
  for (std::uint32_t i = 0; i < kColors; ++i)
    palette_.push_back(heat_color(static_cast<double>(i) / (kColors - 1)));
}

HeatScale HeatMap::color_triangles(const PosedMesh& mesh) {
  residuals_.resize(mesh.model().triangle_count());
  triangle_colors_.resize(residuals_.size());
  triangle_residuals(mesh, residuals_);
  float largest = 0;
  for (const float residual : residuals_) largest = std::max(largest, residual);
  const HeatScale scale{round_scale(100.0 * static_cast<double>(largest)), "% of the diagonal"};
  const double last = static_cast<double>(palette_.size() - 1);
  for (std::size_t t = 0; t < residuals_.size(); ++t) {
    const double share = 100.0 * static_cast<double>(residuals_[t]) / scale.top;
    triangle_colors_[t] =
        static_cast<std::uint32_t>((share > 0 ? std::min(share, 1.0) : 0.0) * last + 0.5);
  }
  return scale;
}

HeatScale HeatMap::color_tiles(std::span<const TraceCounters> tiles,
                               std::uint64_t TraceCounters::*count, std::string_view unit) {
  const auto per_ray = [&](const TraceCounters& work) {
    return static_cast<double>(work.*count) / kTilePixels;
  };
  double largest = 0;
  for (const TraceCounters& work : tiles) largest = std::max(largest, per_ray(work));
  const HeatScale scale{round_scale(largest), unit};
  tile_colors_.clear();
  for (const TraceCounters& work : tiles)
    tile_colors_.push_back(heat_color(per_ray(work) / scale.top));
  return scale;
}

}  // namespace mdk
