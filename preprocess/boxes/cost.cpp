#include "preprocess/boxes/cost.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "common/base/parallel.h"

namespace mdk {
namespace {

constexpr double kOutlier = 8;  // times the median: larger weights count as this

double row_length(const Affine3d& a, int row) {
  return length(Vec3d{a.m[row][0], a.m[row][1], a.m[row][2]});
}

/// Largest value that counts in full.
double outlier_cap(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return kOutlier * *middle;
}

/// Weights at the keys at which the model has an area, in units of that, a list per side.
struct KeyWeights {
  std::vector<double> xy, yz, zx;

  void add(const Affine3d& local_from_world, double model_area) {
    if (!(model_area > 0)) return;
    const AreaWeights w = world_area_weights(local_from_world);
    xy.push_back(w.xy / model_area);
    yz.push_back(w.yz / model_area);
    zx.push_back(w.zx / model_area);
  }
  AreaWeights caps() const { return {outlier_cap(xy), outlier_cap(yz), outlier_cap(zx)}; }
};

KeyWeights key_weights(std::span<const Affine3d> maps, std::span<const double> model_areas) {
  KeyWeights weights;
  for (std::size_t key = 0; key < maps.size(); ++key) weights.add(maps[key], model_areas[key]);
  return weights;
}

}  // namespace

AreaWeights world_area_weights(const Affine3d& local_from_world) {
  const double det =
      std::max(std::abs(local_from_world.determinant()), std::numeric_limits<double>::min());
  return {row_length(local_from_world, 2) / det, row_length(local_from_world, 0) / det,
          row_length(local_from_world, 1) / det};
}

double winsorised_mean(std::span<const double> values) {
  if (values.empty()) return 0;
  const double cap = outlier_cap({values.begin(), values.end()});
  double sum = 0;
  for (const double v : values) sum += std::min(v, cap);
  return sum / static_cast<double>(values.size());
}

AreaWeights mean_area_weights(std::span<const Affine3d> maps, std::span<const double> model_areas) {
  const KeyWeights weights = key_weights(maps, model_areas);
  if (weights.xy.empty()) return {};
  return {winsorised_mean(weights.xy), winsorised_mean(weights.yz), winsorised_mean(weights.zx)};
}

AreaWeights area_weight_caps(std::span<const Affine3d> maps, std::span<const double> model_areas) {
  const KeyWeights weights = key_weights(maps, model_areas);
  return weights.xy.empty() ? AreaWeights{0, 0, 0} : weights.caps();
}

AreaWeightTable::AreaWeightTable(std::span<const Affine3f> local_from_world,
                                 std::span<const double> model_areas)
    : keys_(model_areas.size()),
      clusters_(local_from_world.size() / model_areas.size()),
      sums_(clusters_ * (keys_ + 1)),
      counts_(keys_ + 1, 0) {
  for (std::size_t key = 0; key < keys_; ++key)
    counts_[key + 1] = counts_[key] + (model_areas[key] > 0 ? 1 : 0);
  parallel_chunks(clusters_, 1, [&](std::size_t cluster, std::size_t) {
    KeyWeights weights;
    for (std::size_t key = 0; key < keys_; ++key)
      weights.add(to_double(local_from_world[key * clusters_ + cluster]), model_areas[key]);
    if (weights.xy.empty()) return;
    const AreaWeights cap = weights.caps();
    AreaWeights* sums = &sums_[cluster * (keys_ + 1)];
    sums[0] = {0, 0, 0};
    for (std::size_t key = 0, i = 0; key < keys_; ++key) {
      sums[key + 1] = sums[key];
      if (counts_[key + 1] == counts_[key]) continue;
      sums[key + 1].xy += std::min(weights.xy[i], cap.xy);
      sums[key + 1].yz += std::min(weights.yz[i], cap.yz);
      sums[key + 1].zx += std::min(weights.zx[i], cap.zx);
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
  for (const ClusterWork& c : clusters) sum += c.area();
  return sum;
}

double expected_work(std::span<const ClusterWork> clusters) {
  double sum = 0;
  for (const ClusterWork& c : clusters) sum += c.cost();
  return sum;
}

}  // namespace mdk
