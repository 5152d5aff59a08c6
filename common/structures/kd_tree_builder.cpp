// The greedy SAH descent: sweep every plane where a box starts or ends, take the cheapest, hand
// each child its events in order, stop where no split pays. Cost: a constant number of passes over
// the events of each level, O(N log N) in all.
#include "common/structures/kd_tree_builder.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <string>

#include "common/base/error.h"
#include "common/base/parallel.h"
#include "common/structures/kd_events.h"

namespace mdk {
namespace {

/// Most references per item, over the whole tree. Boxes that overlap a lot (fuzzy boxes of wild
/// motion) let the heuristic copy references for ever smaller gains. On a torus of 80,000 triangles
/// with boxes grown by 0.3, 1, 3 and 10 triangle sizes, trees without a limit hold 8.5, 10, 15 and
/// 18 references per item; a limit of 8 costs 0.4, 2, 8 and 10 % of SAH cost, a limit of 4 costs 12
/// to 41 %.
constexpr std::uint64_t kMaxRefsPerItem = 8;
/// So that references stay below 2^30, as node links and counts must.
constexpr std::size_t kMaxBoxes = KdEvent::kMaxItems / kMaxRefsPerItem;
/// Child links have 30 bits.
constexpr std::size_t kMaxNodes = std::size_t{1} << 30;

/// Chance that a ray which meets a cell also meets the slice of it up to a plane. Area is linear in
/// the extent along the plane's axis: a slice of thickness t (of 1) has the share q + (1 - q) t,
/// q being the share of the two end faces. A cell without area (a line) counts by length: q = 0.
class SliceOdds {
 public:
  SliceOdds(const AreaWeights& weights, const Aabb& cell, std::size_t axis)
      : lo_(cell.lo[axis]), hi_(cell.hi[axis]) {
    Vec3d extent = to_double(cell.hi) - to_double(cell.lo);
    const double area = weights.area(extent);
    const double thickness = extent[axis];
    extent[axis] = 0;
    faces_ = area > 0 ? weights.area(extent) / area : 0;
    slope_ = thickness > 0 ? (1 - faces_) / thickness : 0;
    assert(std::isfinite(faces_) && std::isfinite(slope_));
  }

  double below(float position) const { return faces_ + slope_ * (position - lo_); }
  double above(float position) const { return faces_ + slope_ * (hi_ - position); }

 private:
  double lo_, hi_, faces_, slope_;
};

/// A plane, and what goes where.
struct Split {
  double cost = std::numeric_limits<double>::infinity();
  std::size_t axis = 0;
  float position = 0;
  KdSides planar_side = kBelow;  ///< of flat boxes that lie in the plane
  std::uint32_t below_count = 0, above_count = 0;
};

/// A node's part of space. Its events are on top of the stacks, from `begin` on.
struct Cell {
  Aabb box;
  std::array<std::size_t, 3> begin{};
  std::uint32_t count = 0;
  std::uint32_t depth = 0;
  std::uint64_t max_refs = 0;  ///< what its leaves may list in all; never less than `count`
};

[[maybe_unused]] bool is_finite(const Vec3f& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

std::uint32_t depth_limit(std::uint32_t wanted, std::uint32_t count) {
  // The usual rule (Havran 2000): enough for a balanced tree and then some.
  const auto usual = static_cast<std::uint32_t>(8 + 1.3 * std::log2(std::max(count, 1u)));
  return std::min(wanted == 0 ? usual : wanted, kMaxKdDepth);
}

class KdTreeBuilder {
 public:
  KdTreeBuilder(std::span<const Aabb> boxes, std::uint32_t ref_base, const KdBuildConfig& config)
      : config_(config),
        ref_base_(ref_base),
        stacks_{KdEventStack(boxes, 0), KdEventStack(boxes, 1), KdEventStack(boxes, 2)},
        sides_(boxes.size(), kBoth) {}

  KdTree build(const Aabb& bounds, std::uint32_t count) {
    max_depth_ = depth_limit(config_.max_depth, count);
    tree_.bounds = bounds;
    tree_.nodes.resize(1);
    build_node(0, {bounds, {}, count, 0, kMaxRefsPerItem * count});
    return std::move(tree_);
  }

 private:
  /// Fills node `index` and everything under it. Takes its events off the stacks.
  void build_node(std::uint32_t index, const Cell& cell) {
    check_loop();
    const Split split = cheapest_split(cell);
    if (split.cost >= static_cast<double>(config_.intersect_cost) * cell.count) {
      make_leaf(index, cell);
      return;
    }
    choose_sides(cell, split);
    const auto children = static_cast<std::uint32_t>(tree_.nodes.size());
    tree_.nodes.resize(children + 2u);
    tree_.nodes[index] =
        KdNode::inner(static_cast<std::uint32_t>(split.axis), split.position, children);

    Cell below = cell, above = cell;
    below.box.hi[split.axis] = above.box.lo[split.axis] = split.position;
    below.count = split.below_count;
    above.count = split.above_count;
    below.depth = above.depth = cell.depth + 1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      KdClamp clamp;
      if (axis == split.axis) clamp = {split.position, split.position};
      below.begin[axis] = stacks_[axis].split(cell.begin[axis], sides_, clamp);
    }
    // Each side may copy references in proportion to its items; what the first leaves over is the
    // second one's.
    const std::uint64_t refs_before = tree_.refs.size();
    const std::uint64_t both = std::uint64_t{below.count} + above.count;
    below.max_refs = cell.max_refs * below.count / both;
    build_node(children, below);
    above.max_refs = cell.max_refs - (tree_.refs.size() - refs_before);
    build_node(children + 1, above);
  }

  void make_leaf(std::uint32_t index, const Cell& cell) {
    const std::size_t first = tree_.refs.size();
    for (const KdEvent& event : stacks_[0].top(cell.begin[0]))
      if (event.type() != KdEvent::kEnd) tree_.refs.push_back(ref_base_ + event.item());
    assert(tree_.refs.size() - first == cell.count);
    std::sort(tree_.refs.begin() + static_cast<std::ptrdiff_t>(first), tree_.refs.end());
    tree_.nodes[index] = KdNode::leaf(static_cast<std::uint32_t>(first), cell.count);
    for (std::size_t axis = 0; axis < 3; ++axis) stacks_[axis].pop(cell.begin[axis]);
  }

  /// The plane of least cost strictly inside the cell; cost is infinite where there is none.
  Split cheapest_split(const Cell& cell) const {
    Split best;
    if (cell.count == 0 || cell.depth >= max_depth_) return best;
    if (tree_.nodes.size() + 2 > kMaxNodes) return best;
    for (std::size_t axis = 0; axis < 3; ++axis) sweep(cell, axis, best);
    return best;
  }

  /// Moves a plane along the axis, counting what starts and ends on the way.
  void sweep(const Cell& cell, std::size_t axis, Split& best) const {
    const std::span<const KdEvent> events = stacks_[axis].top(cell.begin[axis]);
    const SliceOdds odds(config_.area, cell.box, axis);
    const float lo = cell.box.lo[axis], hi = cell.box.hi[axis];
    std::uint32_t below = 0, above = cell.count;
    for (std::size_t i = 0; i < events.size();) {
      const float position = events[i].position;
      std::array<std::uint32_t, 3> here{};
      for (; i < events.size() && events[i].position == position; ++i) ++here[events[i].type()];
      const std::uint32_t planar = here[KdEvent::kPlanar];
      above -= planar + here[KdEvent::kEnd];
      if (lo < position && position < hi &&
          std::uint64_t{below} + above + planar <= cell.max_refs) {
        const double p_below = odds.below(position), p_above = odds.above(position);
        consider({split_cost(p_below, below + planar, p_above, above), axis, position, kBelow,
                  below + planar, above},
                 best);
        if (planar != 0)
          consider({split_cost(p_below, below, p_above, above + planar), axis, position, kAbove,
                    below, above + planar},
                   best);
      }
      below += planar + here[KdEvent::kStart];
    }
    assert(below == cell.count && above == 0);
  }

  double split_cost(double p_below, std::uint32_t below, double p_above,
                    std::uint32_t above) const {
    const double cost =
        config_.traversal_cost + config_.intersect_cost * (p_below * below + p_above * above);
    assert(!std::isnan(cost));
    return below == 0 || above == 0 ? cost * config_.empty_bonus : cost;
  }

  static void consider(const Split& candidate, Split& best) {
    if (candidate.cost < best.cost) best = candidate;
  }

  /// Sets `sides_` for every item of the cell. An item's start comes before its end in the list.
  void choose_sides(const Cell& cell, const Split& split) {
    for (const KdEvent& event : stacks_[split.axis].top(cell.begin[split.axis])) {
      KdSides& side = sides_[event.item()];
      if (event.type() == KdEvent::kStart)
        side = event.position >= split.position ? kAbove : kBoth;
      else if (event.position < split.position)
        side = kBelow;
      else if (event.type() == KdEvent::kPlanar)
        side = event.position > split.position ? kAbove : split.planar_side;
      else if (event.position == split.position)
        side = kBelow;
    }
  }

  KdBuildConfig config_;
  std::uint32_t ref_base_ = 0;
  std::uint32_t max_depth_ = 0;
  std::array<KdEventStack, 3> stacks_;
  std::vector<KdSides> sides_;
  KdTree tree_;
};

/// Cost of the subtree at `index` for a ray that meets `cell`.
double expected_cost(const KdTreeView& tree, const KdBuildConfig& config, std::uint32_t index,
                     const Aabb& cell) {
  const KdNode& node = tree.nodes[index];
  if (node.is_leaf()) return static_cast<double>(config.intersect_cost) * node.ref_count();
  const std::size_t axis = node.axis();
  const SliceOdds odds(config.area, cell, axis);
  const float split = std::clamp(node.split(), cell.lo[axis], cell.hi[axis]);
  Aabb below = cell, above = cell;
  below.hi[axis] = above.lo[axis] = split;
  return config.traversal_cost +
         odds.below(split) * expected_cost(tree, config, node.below(), below) +
         odds.above(split) * expected_cost(tree, config, node.above(), above);
}

}  // namespace

KdTree build_kd_tree(std::span<const Aabb> boxes, std::uint32_t ref_base,
                     const KdBuildConfig& config) {
  if (boxes.size() > kMaxBoxes)
    throw Error(ErrorCode::kOverLimit, "a kd-tree holds at most " + std::to_string(kMaxBoxes) +
                                           " boxes, not " + std::to_string(boxes.size()) +
                                           ": use a smaller mesh or more clusters");
  Aabb bounds;
  std::uint32_t count = 0;
  for (const Aabb& box : boxes) {
    if (box.empty()) continue;
    bounds.extend(box);
    ++count;
  }
  assert(count == 0 || (is_finite(bounds.lo) && is_finite(bounds.hi)));
  return KdTreeBuilder(boxes, ref_base, config).build(bounds, count);
}

double sah_cost(const KdTreeView& tree, const KdBuildConfig& config) {
  return expected_cost(tree, config, 0, tree.bounds);
}

}  // namespace mdk
