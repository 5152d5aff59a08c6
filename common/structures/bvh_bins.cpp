#include "common/structures/bvh_bins.h"

#include <algorithm>
#include <cmath>

namespace mdk {

Binning::Binning(const QuadBox& centroids, int bins)
    : lo_(centroids.lo), last_(Quad::filled(static_cast<float>(bins - 1))) {
  // Where the range is a point, or too short or too long to be scaled, all fall into bin 0.
  const auto scale = [&](float lo, float hi) {
    const float per_length = static_cast<float>(bins) / (hi - lo);
    return std::isfinite(per_length) ? per_length : 0.0f;
  };
  for (std::size_t k = 0; k < 3; ++k) scale_.v[k] = scale(centroids.lo.v[k], centroids.hi.v[k]);
  scale_.v[3] = 0;
}

void Bins::clear(int bins) {
  bins_ = static_cast<std::size_t>(bins);
  for (std::vector<Bin>& axis : bin_) {
    if (axis.size() < bins_) axis.resize(bins_);
    std::fill_n(axis.begin(), bins_, Bin{});
  }
  if (cost_below_.size() < bins_) cost_below_.resize(bins_);
}

void Bins::add(std::span<const BuildItem> items, const Binning& binning) {
  Bin* const x = bin_[0].data();
  Bin* const y = bin_[1].data();
  Bin* const z = bin_[2].data();
  const auto put = [](Bin& bin, const QuadBox& box) {
    bin.box.extend(box);
    ++bin.count;
  };
  for (const BuildItem& item : items) {
    const auto b = binning.bin(item.centroid());
    const QuadBox box = item.box();
    put(x[b[0]], box);
    put(y[b[1]], box);
    put(z[b[2]], box);
  }
}

void Bins::merge(const Bins& other) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t b = 0; b < bins_; ++b) {
      bin_[axis][b].box.extend(other.bin_[axis][b].box);
      bin_[axis][b].count += other.bin_[axis][b].count;
    }
}

SahSplit Bins::best_split(const Binning& binning, const QuadBox& whole,
                          const BvhBuildConfig& config) {
  // By area, or by length where all boxes lie on a line and no area is left to compare.
  const bool by_area = whole.half_area() > 0;
  const auto cost = [&](const QuadBox& box, std::uint32_t count) {
    const float measure = by_area ? box.half_area() : box.edge_length();
    return count == 0 ? 0.0f : measure * block_tests(count, config.block);
  };
  SahSplit best;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (binning.is_blind(axis)) continue;
    const std::vector<Bin>& bins = bin_[axis];
    QuadBox box;
    std::uint32_t count = 0;
    for (std::size_t plane = 1; plane < bins_; ++plane) {
      box.extend(bins[plane - 1].box);
      count += bins[plane - 1].count;
      cost_below_[plane] = cost(box, count);
    }
    const std::uint32_t all = count + bins[bins_ - 1].count;
    box = {};
    count = 0;
    for (std::size_t plane = bins_ - 1; plane > 0; --plane) {
      box.extend(bins[plane].box);
      count += bins[plane].count;
      const float sum = cost_below_[plane] + cost(box, count);
      if (count != 0 && count != all && sum < best.cost)
        best = {sum, axis, static_cast<std::int32_t>(plane), all - count};
    }
  }
  return best;
}

std::uint32_t Bins::count_below(std::size_t axis, std::int32_t plane) const {
  std::uint32_t count = 0;
  for (std::size_t b = 0; b < static_cast<std::size_t>(plane); ++b) count += bin_[axis][b].count;
  return count;
}

}  // namespace mdk
