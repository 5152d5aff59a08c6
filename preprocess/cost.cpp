#include "preprocess/cost.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mdk {
namespace {

double row_length(const Affine3d& a, int row) {
  return length(Vec3d{a.m[row][0], a.m[row][1], a.m[row][2]});
}

}  // namespace

AreaWeights world_area_weights(const Affine3d& local_from_world) {
  const double det =
      std::max(std::abs(local_from_world.determinant()), std::numeric_limits<double>::min());
  return {row_length(local_from_world, 2) / det, row_length(local_from_world, 0) / det,
          row_length(local_from_world, 1) / det};
}

double winsorised_mean(std::span<const double> values, double outlier) {
  if (values.empty()) return 0;
  std::vector<double> sorted(values.begin(), values.end());
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  const double cap = outlier * *middle;
  double sum = 0;
  for (const double v : values) sum += std::min(v, cap);
  return sum / static_cast<double>(values.size());
}

AreaWeights mean_area_weights(std::span<const Affine3d> maps, std::span<const double> model_areas,
                              const CostOptions& options) {
  std::vector<double> xy, yz, zx;
  for (std::size_t k = 0; k < maps.size(); ++k) {
    if (!(model_areas[k] > 0)) continue;
    const AreaWeights w = world_area_weights(maps[k]);
    xy.push_back(w.xy / model_areas[k]);
    yz.push_back(w.yz / model_areas[k]);
    zx.push_back(w.zx / model_areas[k]);
  }
  if (xy.empty()) return {};
  return {winsorised_mean(xy, options.outlier), winsorised_mean(yz, options.outlier),
          winsorised_mean(zx, options.outlier)};
}

double fuzzy_area(std::span<const ClusterWork> clusters) {
  double sum = 0;
  for (const ClusterWork& c : clusters) sum += c.fuzzy_boxes.area(c.weights);
  return sum;
}

double expected_work(std::span<const ClusterWork> clusters, const CostOptions& options) {
  double met = 0;
  for (const ClusterWork& c : clusters) met += c.hit_probability;
  return fuzzy_area(clusters) + met * options.transform_cost;
}

}  // namespace mdk
