// Top-down binned SAH: centroids fall into bins along each axis, planes between bins are the
// candidates, and the items of a node are partitioned in place. Every decision depends on sets of
// items only, never on their order within a node, so the result is the same on every machine.
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include "common/structures/bvh.h"

namespace mdk {
namespace {

constexpr int kMaxBins = 1024;

/// A box and its number, moved together so that a pass over a node reads memory in order.
struct Item {
  Aabb box;
  std::uint32_t index;

  /// Halved before they are added, so that the sum stays in the range of float.
  Vec3f centroid() const { return box.lo * 0.5f + box.hi * 0.5f; }
};

struct Bin {
  Aabb box;
  std::uint32_t count = 0;
};

/// Which bin of an axis a centroid falls into.
class Binning {
 public:
  Binning() = default;
  Binning(float lo, float hi, int bins) : lo_(lo), last_(bins - 1) {
    // Where the range is a point, or too short or too long to be scaled, all fall into bin 0.
    const float scale = static_cast<float>(bins) / (hi - lo);
    if (std::isfinite(scale)) scale_ = scale;
  }

  bool usable() const { return scale_ > 0; }
  int bins() const { return last_ + 1; }
  int bin(float centroid) const {
    return usable() ? std::min(static_cast<int>((centroid - lo_) * scale_), last_) : 0;
  }

 private:
  float lo_ = 0, scale_ = 0;
  int last_ = 0;
};

struct Split {
  double cost = std::numeric_limits<double>::infinity();
  std::size_t axis = 0;
  int plane = 0;  ///< items in bins below it go to the first child
  std::uint32_t below_count = 0;

  bool found() const { return below_count != 0; }
};

/// How much of the rays a box catches, next to its ancestors: by area, or by length where all boxes
/// of a node lie on a line and no area is left to compare.
struct Measure {
  bool by_area;

  explicit Measure(const Aabb& node) : by_area(area(node) > 0) {}
  double operator()(const Aabb& box) const { return by_area ? area(box) : length(box); }

 private:
  static double area(const Aabb& box) {
    const Vec3d e = to_double(box.hi) - to_double(box.lo);
    return 2 * (e.x * e.y + e.y * e.z + e.z * e.x);
  }
  static double length(const Aabb& box) {
    const Vec3d e = to_double(box.hi) - to_double(box.lo);
    return e.x + e.y + e.z;
  }
};

/// A run of items that becomes a subtree.
struct Range {
  std::uint32_t begin, end, depth;

  std::uint32_t count() const { return end - begin; }
};

class BvhBuilder {
 public:
  BvhBuilder(std::span<const Aabb> boxes, const BvhBuildConfig& config) : config_(config) {
    assert(config.bins >= 2 && config.bins <= kMaxBins && config.max_leaf >= 1);
    items_.reserve(boxes.size());
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      assert(!boxes[i].empty());
      items_.push_back({boxes[i], static_cast<std::uint32_t>(i)});
    }
    for (auto& axis_bins : bins_) axis_bins.resize(static_cast<std::size_t>(config.bins));
    cost_below_.resize(static_cast<std::size_t>(config.bins));
  }

  Bvh build() {
    if (items_.empty()) return {};
    bvh_.nodes.reserve(2 * (items_.size() / config_.max_leaf + 1));
    bvh_.refs.reserve(items_.size());
    bvh_.nodes.resize(1);
    build_node(0, {0, static_cast<std::uint32_t>(items_.size()), 0});
    return std::move(bvh_);
  }

 private:
  void build_node(std::uint32_t index, const Range& range) {
    Aabb box, centroids;
    for (std::uint32_t i = range.begin; i < range.end; ++i) {
      box.extend(items_[i].box);
      centroids.extend(items_[i].centroid());
    }
    bvh_.nodes[index].set_box(box);
    const std::uint32_t middle = divide(range, box, centroids);
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
    const std::size_t first = bvh_.refs.size();
    for (std::uint32_t i = range.begin; i < range.end; ++i) bvh_.refs.push_back(items_[i].index);
    std::sort(bvh_.refs.begin() + static_cast<std::ptrdiff_t>(first), bvh_.refs.end());
    bvh_.nodes[index].first = static_cast<std::uint32_t>(first);
    bvh_.nodes[index].count = range.count();
  }

  /// Orders the items so that those of the first child come first. Returns where the second child's
  /// begin, or range.begin for a leaf.
  std::uint32_t divide(const Range& range, const Aabb& box, const Aabb& centroids) {
    const std::uint32_t count = range.count();
    if (count == 1 || range.depth == kMaxBvhDepth) return range.begin;
    const Measure measure(box);
    const std::array<Binning, 3> binnings = choose_bins(centroids, count);
    fill_bins(range, binnings);
    Split best;
    for (std::size_t axis = 0; axis < 3; ++axis)
      sweep(binnings[axis], axis, {measure, count}, best);

    if (count <= config_.max_leaf) {
      const double whole = measure(box);
      const double leaf_cost = config_.intersect_cost * count * whole;
      if (!best.found() || config_.traversal_cost * whole + best.cost >= leaf_cost)
        return range.begin;
    }
    // A split so lopsided that its larger part might not fit under the depth limit is not taken.
    const std::uint32_t larger = std::max(best.below_count, count - best.below_count);
    if (!best.found() || larger > most_items_at(range.depth + 1)) return halve(range, centroids);
    const Binning& binning = binnings[best.axis];
    const auto middle = std::partition(
        items_.begin() + range.begin, items_.begin() + range.end,
        [&](const Item& item) { return binning.bin(item.centroid()[best.axis]) < best.plane; });
    return static_cast<std::uint32_t>(middle - items_.begin());
  }

  /// How many items a node of this depth can hold if it is halved from there on.
  std::uint64_t most_items_at(std::uint32_t depth) const {
    const std::uint32_t levels = std::min(kMaxBvhDepth - depth, 32u);
    return std::uint64_t{config_.max_leaf} << levels;
  }

  /// Object median along the widest axis; equal centroids are told apart by number.
  std::uint32_t halve(const Range& range, const Aabb& centroids) {
    const Vec3f extent = centroids.extent();
    std::size_t axis = 0;
    for (std::size_t a = 1; a < 3; ++a)
      if (extent[a] > extent[axis]) axis = a;
    const std::uint32_t middle = range.begin + range.count() / 2;
    std::nth_element(items_.begin() + range.begin, items_.begin() + middle,
                     items_.begin() + range.end, [axis](const Item& a, const Item& b) {
                       return std::pair(a.centroid()[axis], a.index) <
                              std::pair(b.centroid()[axis], b.index);
                     });
    return middle;
  }

  /// More bins than twice the items would tell nothing new.
  std::array<Binning, 3> choose_bins(const Aabb& centroids, std::uint32_t count) const {
    const int bins = count < static_cast<std::uint32_t>(kMaxBins)
                         ? std::min(config_.bins, 2 * static_cast<int>(count))
                         : config_.bins;
    return {Binning(centroids.lo.x, centroids.hi.x, bins),
            Binning(centroids.lo.y, centroids.hi.y, bins),
            Binning(centroids.lo.z, centroids.hi.z, bins)};
  }

  void fill_bins(const Range& range, const std::array<Binning, 3>& binnings) {
    for (std::size_t axis = 0; axis < 3; ++axis)
      std::fill_n(bins_[axis].begin(), binnings[axis].bins(), Bin{});
    const auto add = [](Bin& bin, const Aabb& box) {
      bin.box.extend(box);
      ++bin.count;
    };
    const auto [x, y, z] = binnings;
    Bin* const bins_x = bins_[0].data();
    Bin* const bins_y = bins_[1].data();
    Bin* const bins_z = bins_[2].data();
    for (std::uint32_t i = range.begin; i < range.end; ++i) {
      const Aabb box = items_[i].box;
      const Vec3f centroid = items_[i].centroid();
      add(bins_x[x.bin(centroid.x)], box);
      add(bins_y[y.bin(centroid.y)], box);
      add(bins_z[z.bin(centroid.z)], box);
    }
  }

  struct Node {
    Measure measure;
    std::uint32_t count;
  };

  /// Costs of all planes of an axis, from prefixes and suffixes of the bins.
  void sweep(const Binning& binning, std::size_t axis, const Node& node, Split& best) {
    if (!binning.usable()) return;
    const std::vector<Bin>& bins = bins_[axis];
    const auto cost = [&](const Aabb& box, std::uint32_t count) {
      return count == 0 ? 0 : config_.intersect_cost * node.measure(box) * count;
    };
    Aabb box;
    std::uint32_t count = 0;
    for (int plane = 1; plane < binning.bins(); ++plane) {
      const Bin& bin = bins[static_cast<std::size_t>(plane - 1)];
      box.extend(bin.box);
      count += bin.count;
      cost_below_[static_cast<std::size_t>(plane)] = cost(box, count);
    }
    box = {};
    count = 0;
    for (int plane = binning.bins() - 1; plane > 0; --plane) {
      const Bin& bin = bins[static_cast<std::size_t>(plane)];
      box.extend(bin.box);
      count += bin.count;
      const double sum = cost_below_[static_cast<std::size_t>(plane)] + cost(box, count);
      if (count != 0 && count != node.count && sum < best.cost)
        best = {sum, axis, plane, node.count - count};
    }
  }

  BvhBuildConfig config_;
  std::vector<Item> items_;
  std::array<std::vector<Bin>, 3> bins_;
  std::vector<double> cost_below_;  ///< by plane
  Bvh bvh_;
};

}  // namespace

Bvh build_bvh(std::span<const Aabb> boxes, const BvhBuildConfig& config) {
  return BvhBuilder(boxes, config).build();
}

}  // namespace mdk
