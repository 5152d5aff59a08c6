#include "preprocess/cost.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "common/base/parallel.h"

namespace mdk {
namespace {

double row_length(const Affine3d& a, int row) {
  return length(Vec3d{a.m[row][0], a.m[row][1], a.m[row][2]});
}

/// Largest value that counts in full.
double outlier_cap(std::span<const double> values, double outlier) {
  std::vector<double> sorted(values.begin(), values.end());
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  return outlier * *middle;
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
  const double cap = outlier_cap(values, outlier);
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

AreaWeightTable::AreaWeightTable(std::span<const Affine3f> local_from_world,
                                 std::span<const double> model_areas, const CostOptions& options)
    : keys_(model_areas.size()),
      clusters_(local_from_world.size() / model_areas.size()),
      sums_(clusters_ * (keys_ + 1)),
      counts_(keys_ + 1, 0) {
  for (std::size_t key = 0; key < keys_; ++key)
    counts_[key + 1] = counts_[key] + (model_areas[key] > 0 ? 1 : 0);
  parallel_chunks(clusters_, 1, [&](std::size_t cluster, std::size_t) {
    std::vector<double> xy, yz, zx;
    for (std::size_t key = 0; key < keys_; ++key) {
      if (!(model_areas[key] > 0)) continue;
      const AreaWeights w =
          world_area_weights(to_double(local_from_world[key * clusters_ + cluster]));
      xy.push_back(w.xy / model_areas[key]);
      yz.push_back(w.yz / model_areas[key]);
      zx.push_back(w.zx / model_areas[key]);
    }
    if (xy.empty()) return;
    const AreaWeights cap{outlier_cap(xy, options.outlier), outlier_cap(yz, options.outlier),
                          outlier_cap(zx, options.outlier)};
    AreaWeights* sums = &sums_[cluster * (keys_ + 1)];
    sums[0] = {0, 0, 0};
    for (std::size_t key = 0, i = 0; key < keys_; ++key) {
      sums[key + 1] = sums[key];
      if (counts_[key + 1] == counts_[key]) continue;
      sums[key + 1].xy += std::min(xy[i], cap.xy);
      sums[key + 1].yz += std::min(yz[i], cap.yz);
      sums[key + 1].zx += std::min(zx[i], cap.zx);
      ++i;
    }
  });
}

AreaWeights AreaWeightTable::mean(std::size_t cluster, std::uint32_t first_key,
                                  std::uint32_t last_key) const {
  const std::uint32_t count = counts_[last_key + std::size_t{1}] - counts_[first_key];
  if (count == 0) return {};
  const AreaWeights* sums = &sums_[cluster * (keys_ + 1)];
  const AreaWeights &to = sums[last_key + std::size_t{1}], &from = sums[first_key];
  return {(to.xy - from.xy) / count, (to.yz - from.yz) / count, (to.zx - from.zx) / count};
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
