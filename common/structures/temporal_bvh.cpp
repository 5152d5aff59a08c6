#include "common/structures/temporal_bvh.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "common/base/parallel.h"

namespace mdk {
namespace {

constexpr std::uint32_t kMostBins = 64;
constexpr std::uint32_t kMostSplitPoses = 3;  ///< whose centroids splits are sought among
/// From here on nodes are halved: 2^27 items then end above kMaxBvhDepth.
constexpr std::uint32_t kDeepestSplit = kMaxBvhDepth - 30;

double area(const Aabb& box) {
  if (box.empty()) return 0;
  const Vec3d e = to_double(box.hi) - to_double(box.lo);
  return e.x * e.y + e.y * e.z + e.z * e.x;
}

/// Halved before they are added, so that the sum stays in the range of float.
float centroid(const Aabb& box, std::size_t axis) {
  return box.lo[axis] * 0.5f + box.hi[axis] * 0.5f;
}

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

struct Split {
  double cost = std::numeric_limits<double>::infinity();
  Ruler ruler;
  std::uint32_t plane = 0;  ///< items in bins below it go to the first child
};

struct Range {
  std::uint32_t begin, end, depth;

  std::uint32_t count() const { return end - begin; }
};

class TemporalBuilder {
 public:
  TemporalBuilder(std::span<const Aabb> boxes, std::uint32_t poses, const BvhBuildConfig& config)
      : boxes_(boxes),
        poses_(poses),
        count_(static_cast<std::uint32_t>(boxes.size() / poses)),
        config_(config),
        items_(count_),
        pose_weights_(poses) {
    std::iota(items_.begin(), items_.end(), 0u);
    bins_ = std::min(static_cast<std::uint32_t>(config.bins), kMostBins);
    bin_boxes_.resize(std::size_t{bins_} * poses_);
    bin_counts_.resize(bins_);
    below_.resize(bins_);
  }

  Bvh build() {
    if (count_ == 0) return {};
    std::vector<Aabb> root(poses_);
    for (std::uint32_t p = 0; p < poses_; ++p) {
      for (const Aabb& box : pose(p)) root[p].extend(box);
      pose_weights_[p] = area(root[p]) > 0 ? 1 / area(root[p]) : 0;
    }
    bvh_.refs.reserve(count_);
    bvh_.nodes.resize(1);
    build_node(0, {0, count_, 0});
    return std::move(bvh_);
  }

 private:
  std::span<const Aabb> pose(std::uint32_t p) const {
    return boxes_.subspan(std::size_t{p} * count_, count_);
  }

  /// Chance that a ray that meets the root meets these boxes, one per pose: summed over the poses.
  double measure(const Aabb* boxes) const {
    double sum = 0;
    for (std::uint32_t p = 0; p < poses_; ++p) sum += pose_weights_[p] * area(boxes[p]);
    return sum;
  }

  void build_node(std::uint32_t index, const Range& range) {
    check_loop();
    std::vector<Aabb> node(poses_);
    for (std::uint32_t p = 0; p < poses_; ++p)
      for (std::uint32_t i = range.begin; i < range.end; ++i) node[p].extend(pose(p)[items_[i]]);
    bvh_.nodes[index].set_box(node[0]);
    const std::uint32_t middle = divide(range, measure(node.data()));
    if (middle == range.begin) {
      make_leaf(index, range);
      return;
    }
    const auto children = static_cast<std::uint32_t>(bvh_.nodes.size());
    bvh_.nodes[index].first = children;
    bvh_.nodes.resize(children + 2u);
    build_node(children, {range.begin, middle, range.depth + 1});
    build_node(children + 1, {middle, range.end, range.depth + 1});
  }

  void make_leaf(std::uint32_t index, const Range& range) {
    const auto first = static_cast<std::uint32_t>(bvh_.refs.size());
    bvh_.refs.insert(bvh_.refs.end(), items_.begin() + range.begin, items_.begin() + range.end);
    std::sort(bvh_.refs.begin() + first, bvh_.refs.end());
    bvh_.nodes[index].first = first;
    bvh_.nodes[index].count = range.count();
  }

  /// Orders the items so that those of the first child come first. Returns where the second child's
  /// begin, or range.begin for a leaf.
  std::uint32_t divide(const Range& range, double whole) {
    const std::uint32_t count = range.count();
    if (count == 1) return range.begin;
    Split best;
    if (range.depth < kDeepestSplit)
      for (std::uint32_t s = 0; s < std::min(poses_, kMostSplitPoses); ++s)
        for (std::size_t axis = 0; axis < 3; ++axis)
          try_axis(range, s * poses_ / std::min(poses_, kMostSplitPoses), axis, best);

    const bool is_found = std::isfinite(best.cost);
    if (count <= config_.max_leaf) {
      const double leaf_cost = config_.intersect_cost * count * whole;
      if (!is_found || config_.traversal_cost * whole + best.cost >= leaf_cost) return range.begin;
    }
    if (!is_found) return halve(range);
    const auto middle =
        std::partition(items_.begin() + range.begin, items_.begin() + range.end,
                       [&](std::uint32_t item) { return best.ruler.bin(item) < best.plane; });
    return static_cast<std::uint32_t>(middle - items_.begin());
  }

  /// Halves by number: only where centroids tell nothing or the depth runs out.
  std::uint32_t halve(const Range& range) {
    const std::uint32_t middle = range.begin + range.count() / 2;
    std::nth_element(items_.begin() + range.begin, items_.begin() + middle,
                     items_.begin() + range.end);
    return middle;
  }

  void try_axis(const Range& range, std::uint32_t p, std::size_t axis, Split& best) {
    Ruler ruler;
    ruler.boxes = pose(p).data();
    ruler.axis = axis;
    ruler.bins = std::min(bins_, 2 * range.count());
    float hi = -std::numeric_limits<float>::infinity();
    ruler.lo = -hi;
    for (std::uint32_t i = range.begin; i < range.end; ++i) {
      const float c = centroid(ruler.boxes[items_[i]], axis);
      ruler.lo = std::min(ruler.lo, c);
      hi = std::max(hi, c);
    }
    ruler.scale = static_cast<float>(ruler.bins) / (hi - ruler.lo);
    if (!std::isfinite(ruler.scale) || ruler.scale <= 0) return;  // a point, or too short or long
    fill_bins(range, ruler);
    sweep(range.count(), ruler, best);
  }

  void fill_bins(const Range& range, const Ruler& ruler) {
    std::fill_n(bin_boxes_.begin(), std::size_t{ruler.bins} * poses_, Aabb{});
    std::fill_n(bin_counts_.begin(), ruler.bins, 0u);
    for (std::uint32_t i = range.begin; i < range.end; ++i) {
      const std::uint32_t item = items_[i], bin = ruler.bin(item);
      ++bin_counts_[bin];
      for (std::uint32_t p = 0; p < poses_; ++p)
        bin_boxes_[std::size_t{bin} * poses_ + p].extend(pose(p)[item]);
    }
  }

  void sweep(std::uint32_t count, const Ruler& ruler, Split& best) {
    const auto cost = [&](const std::vector<Aabb>& side, std::uint32_t items) {
      return config_.intersect_cost * measure(side.data()) * items;
    };
    const auto add_bin = [&](std::vector<Aabb>& side, std::uint32_t bin) {
      for (std::uint32_t p = 0; p < poses_; ++p)
        side[p].extend(bin_boxes_[std::size_t{bin} * poses_ + p]);
    };
    std::vector<Aabb> side(poses_);
    std::uint32_t items = 0;
    for (std::uint32_t plane = 1; plane < ruler.bins; ++plane) {
      add_bin(side, plane - 1);
      items += bin_counts_[plane - 1];
      below_[plane] = cost(side, items);
    }
    side.assign(poses_, Aabb{});
    items = 0;
    for (std::uint32_t plane = ruler.bins - 1; plane > 0; --plane) {
      add_bin(side, plane);
      items += bin_counts_[plane];
      const double sum = below_[plane] + cost(side, items);
      if (items != 0 && items != count && sum < best.cost) best = {sum, ruler, plane};
    }
  }

  std::span<const Aabb> boxes_;
  std::uint32_t poses_, count_, bins_ = 0;
  BvhBuildConfig config_;
  std::vector<std::uint32_t> items_;
  std::vector<double> pose_weights_;
  std::vector<Aabb> bin_boxes_;  ///< by bin, then pose
  std::vector<std::uint32_t> bin_counts_;
  std::vector<double> below_;  ///< cost of what is below a plane
  Bvh bvh_;
};

}  // namespace

Bvh build_temporal_bvh(std::span<const Aabb> boxes, std::uint32_t poses,
                       const BvhBuildConfig& config) {
  assert(poses > 0 && boxes.size() % poses == 0 && config.bins >= 2);
  return TemporalBuilder(boxes, poses, config).build();
}

}  // namespace mdk
