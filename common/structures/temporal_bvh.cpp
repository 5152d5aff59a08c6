// build_temporal_bvh(): a node's cost is summed over the poses, each relative to its root's area.
// Items are told apart by their centroids in one of a few poses, along one axis, in bins.
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "common/base/parallel.h"
#include "common/structures/bvh.h"
#include "common/structures/top_down.h"

namespace mdk {
namespace {

constexpr std::uint32_t kMaxBins = 64;
constexpr std::uint32_t kMaxSplitPoses = 3;  ///< whose centroids splits are sought among
/// From here on nodes are halved: 2^27 items then end above kMaxBvhDepth.
constexpr std::uint32_t kMaxSplitDepth = kMaxBvhDepth - 30;

/// A way to tell items apart: by their centroids in one pose, along one axis, cut into bins.
struct Ruler {
  const Aabb* boxes = nullptr;  ///< of the pose
  std::size_t axis = 0;
  float lo = 0, scale = 0;
  std::uint32_t bins = 0;

  std::uint32_t bin(std::uint32_t item) const {
    const float place = (centroid(boxes[item], axis) - lo) * scale;
    return std::min(static_cast<std::uint32_t>(place), bins - 1);
  }
};

struct Plane {
  double cost = std::numeric_limits<double>::infinity();
  Ruler ruler;
  std::uint32_t bin = 0;  ///< items in bins below it go to the first child
};

/// A run of items that becomes a subtree.
struct Run {
  std::uint32_t begin, end, depth;
  Aabb box;       ///< in the first pose
  double chance;  ///< that a ray that hits the root hits it, summed over the poses

  std::uint32_t count() const { return end - begin; }
};

struct Halves {
  Run below, above;
};

class TemporalSplitter {
 public:
  using Part = Run;
  using Split = Halves;

  TemporalSplitter(std::span<const Aabb> boxes, std::uint32_t poses, const BvhBuildConfig& config)
      : boxes_(boxes),
        poses_(poses),
        count_(static_cast<std::uint32_t>(boxes.size() / poses)),
        bins_(std::min(static_cast<std::uint32_t>(config.bins), kMaxBins)),
        config_(config),
        items_(count_),
        bin_boxes_(std::size_t{bins_} * poses),
        bin_counts_(bins_),
        below_(bins_) {
    std::iota(items_.begin(), items_.end(), 0u);
    refs_.reserve(count_);
    for (std::uint32_t p = 0; p < poses_; ++p) {
      Aabb root;
      for (const Aabb& box : pose(p)) root.extend(box);
      pose_weights_.push_back(half_area(root) > 0 ? 1 / half_area(root) : 0);
    }
  }

  Run whole() const { return make_run(0, count_, 0); }
  std::vector<std::uint32_t> take_refs() { return std::move(refs_); }

  std::optional<Halves> try_split(const Run& run) {
    check_loop();
    if (run.count() == 1) return {};
    const Plane best = cheapest_plane(run);
    const bool is_found = std::isfinite(best.cost);
    if (run.count() <= config_.max_leaf) {
      const double leaf_cost = config_.intersect_cost * run.count() * run.chance;
      if (!is_found || config_.traversal_cost * run.chance + best.cost >= leaf_cost) return {};
    }
    const std::uint32_t middle = is_found ? part(run, best) : halve(run);
    return Halves{make_run(run.begin, middle, run.depth + 1),
                  make_run(middle, run.end, run.depth + 1)};
  }

  BvhNode make_inner(const Run& run, const Halves&, std::uint32_t children) const {
    return BvhNode::inner(run.box, children);
  }

  BvhNode make_leaf(const Run& run) {
    const auto first = static_cast<std::uint32_t>(refs_.size());
    refs_.insert(refs_.end(), items_.begin() + run.begin, items_.begin() + run.end);
    std::sort(refs_.begin() + first, refs_.end());
    return BvhNode::leaf(run.box, first, run.count());
  }

 private:
  std::span<const Aabb> pose(std::uint32_t p) const {
    return boxes_.subspan(std::size_t{p} * count_, count_);
  }

  /// Chance that a ray that hits the root hits these boxes, one per pose: summed over the poses.
  double chance(const std::vector<Aabb>& boxes) const {
    double sum = 0;
    for (std::uint32_t p = 0; p < poses_; ++p) sum += pose_weights_[p] * half_area(boxes[p]);
    return sum;
  }

  Run make_run(std::uint32_t begin, std::uint32_t end, std::uint32_t depth) const {
    std::vector<Aabb> boxes(poses_);
    for (std::uint32_t p = 0; p < poses_; ++p)
      for (std::uint32_t i = begin; i < end; ++i) boxes[p].extend(pose(p)[items_[i]]);
    return {begin, end, depth, boxes[0], chance(boxes)};
  }

  /// Puts the items of the first child first. Returns where those of the second one begin.
  std::uint32_t part(const Run& run, const Plane& plane) {
    const auto middle =
        std::partition(items_.begin() + run.begin, items_.begin() + run.end,
                       [&](std::uint32_t item) { return plane.ruler.bin(item) < plane.bin; });
    return static_cast<std::uint32_t>(middle - items_.begin());
  }

  /// Halves by number: only where centroids tell nothing or the depth runs out.
  std::uint32_t halve(const Run& run) {
    const std::uint32_t middle = run.begin + run.count() / 2;
    std::nth_element(items_.begin() + run.begin, items_.begin() + middle, items_.begin() + run.end);
    return middle;
  }

  Plane cheapest_plane(const Run& run) {
    Plane best;
    if (run.depth >= kMaxSplitDepth) return best;
    const std::uint32_t tried = std::min(poses_, kMaxSplitPoses);
    for (std::uint32_t s = 0; s < tried; ++s)
      for (std::size_t axis = 0; axis < 3; ++axis) try_axis(run, s * poses_ / tried, axis, best);
    return best;
  }

  void try_axis(const Run& run, std::uint32_t p, std::size_t axis, Plane& best) {
    Ruler ruler;
    ruler.boxes = pose(p).data();
    ruler.axis = axis;
    ruler.bins = std::min(bins_, 2 * run.count());
    float hi = -std::numeric_limits<float>::infinity();
    ruler.lo = -hi;
    for (std::uint32_t i = run.begin; i < run.end; ++i) {
      const float c = centroid(ruler.boxes[items_[i]], axis);
      ruler.lo = std::min(ruler.lo, c);
      hi = std::max(hi, c);
    }
    ruler.scale = static_cast<float>(ruler.bins) / (hi - ruler.lo);
    if (!std::isfinite(ruler.scale) || ruler.scale <= 0) return;  // a point, or too short or long
    fill_bins(run, ruler);
    sweep(run.count(), ruler, best);
  }

  void fill_bins(const Run& run, const Ruler& ruler) {
    std::fill_n(bin_boxes_.begin(), std::size_t{ruler.bins} * poses_, Aabb{});
    std::fill_n(bin_counts_.begin(), ruler.bins, 0u);
    for (std::uint32_t i = run.begin; i < run.end; ++i) {
      const std::uint32_t item = items_[i], bin = ruler.bin(item);
      ++bin_counts_[bin];
      for (std::uint32_t p = 0; p < poses_; ++p)
        bin_boxes_[std::size_t{bin} * poses_ + p].extend(pose(p)[item]);
    }
  }

  void sweep(std::uint32_t count, const Ruler& ruler, Plane& best) {
    const auto cost = [&](const std::vector<Aabb>& side, std::uint32_t items) {
      return config_.intersect_cost * chance(side) * items;
    };
    const auto add_bin = [&](std::vector<Aabb>& side, std::uint32_t bin) {
      for (std::uint32_t p = 0; p < poses_; ++p)
        side[p].extend(bin_boxes_[std::size_t{bin} * poses_ + p]);
    };
    std::vector<Aabb> side(poses_);
    std::uint32_t items = 0;
    for (std::uint32_t bin = 1; bin < ruler.bins; ++bin) {
      add_bin(side, bin - 1);
      items += bin_counts_[bin - 1];
      below_[bin] = cost(side, items);
    }
    side.assign(poses_, Aabb{});
    items = 0;
    for (std::uint32_t bin = ruler.bins - 1; bin > 0; --bin) {
      add_bin(side, bin);
      items += bin_counts_[bin];
      const double sum = below_[bin] + cost(side, items);
      if (items != 0 && items != count && sum < best.cost) best = {sum, ruler, bin};
    }
  }

  std::span<const Aabb> boxes_;
  std::uint32_t poses_, count_, bins_;
  BvhBuildConfig config_;
  std::vector<std::uint32_t> items_, refs_;
  std::vector<double> pose_weights_;
  std::vector<Aabb> bin_boxes_;  ///< by bin, then pose
  std::vector<std::uint32_t> bin_counts_;
  std::vector<double> below_;  ///< cost of what is below a bin
};

}  // namespace

Bvh build_temporal_bvh(std::span<const Aabb> boxes, std::uint32_t poses,
                       const BvhBuildConfig& config) {
  assert(poses > 0 && boxes.size() % poses == 0 && config.bins >= 2);
  Bvh bvh;
  if (boxes.empty()) return bvh;
  TemporalSplitter splitter(boxes, poses, config);
  bvh.nodes = build_top_down<BvhNode>(splitter, splitter.whole(), 1);
  bvh.refs = splitter.take_refs();
  assert(validate(bvh, boxes.first(boxes.size() / poses), config.max_leaf).empty());
  return bvh;
}

}  // namespace mdk
