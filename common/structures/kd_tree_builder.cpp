// build_kd_tree(): sweep every plane where a box starts or ends, take the cheapest, hand each child
// its events in order, stop where no split pays. Boxes are clipped to the cell on the way down.
// Cost: a constant number of passes over the events of each level, O(N log N) in all.
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "common/base/error.h"
#include "common/base/parallel.h"
#include "common/structures/kd_events.h"
#include "common/structures/kd_tree.h"
#include "common/structures/top_down.h"

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

/// Chance that a ray which hits a cell also hits the slice of it up to a plane. Area is linear in
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
struct Plane {
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
  std::uint64_t max_refs = 0;  ///< of the tree when this cell is done
};

struct Cells {
  std::size_t axis;
  float position;
  Cell below, above;
};

[[maybe_unused]] bool is_finite(const Vec3f& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

std::uint32_t depth_limit(std::uint32_t wanted, std::uint32_t count) {
  // The usual rule (Havran 2000): enough for a balanced tree and then some.
  const auto usual = static_cast<std::uint32_t>(8 + 1.3 * std::log2(std::max(count, 1u)));
  return std::min(wanted == 0 ? usual : wanted, kMaxKdDepth);
}

class KdSplitter {
 public:
  using Part = Cell;
  using Split = Cells;

  KdSplitter(std::span<const Aabb> boxes, std::uint32_t ref_base, const KdBuildConfig& config,
             std::uint32_t max_depth)
      : config_(config),
        ref_base_(ref_base),
        max_depth_(max_depth),
        stacks_{KdEventStack(boxes, 0), KdEventStack(boxes, 1), KdEventStack(boxes, 2)},
        sides_(boxes.size(), kBoth) {}

  std::vector<std::uint32_t> take_refs() { return std::move(refs_); }

  std::optional<Cells> try_split(const Cell& cell) {
    check_loop();
    const Plane plane = cheapest_plane(cell);
    if (plane.cost >= static_cast<double>(config_.intersect_cost) * cell.count) return {};
    choose_sides(cell, plane);
    Cells cells{plane.axis, plane.position, cell, cell};
    Cell &below = cells.below, &above = cells.above;
    below.box.hi[plane.axis] = above.box.lo[plane.axis] = plane.position;
    below.count = plane.below_count;
    above.count = plane.above_count;
    below.depth = above.depth = cell.depth + 1;
    for (std::size_t axis = 0; axis < 3; ++axis)
      below.begin[axis] = axis == plane.axis
                              ? stacks_[axis].split_at(plane.position, cell.begin[axis], sides_)
                              : stacks_[axis].split_across(cell.begin[axis], sides_);
    // Each side may copy references in proportion to its items; what the first leaves over is the
    // second one's.
    const std::uint64_t both = std::uint64_t{below.count} + above.count;
    below.max_refs = refs_.size() + refs_left(cell) * below.count / both;
    node_count_ += 2;
    return cells;
  }

  KdNode make_inner(const Cell&, const Cells& cells, std::uint32_t children) const {
    return KdNode::inner(static_cast<std::uint32_t>(cells.axis), cells.position, children);
  }

  /// Takes the cell's events off the stacks.
  KdNode make_leaf(const Cell& cell) {
    const std::size_t first = refs_.size();
    for (const KdEvent& event : stacks_[0].top(cell.begin[0]))
      if (event.type() != KdEvent::kEnd) refs_.push_back(ref_base_ + event.item());
    assert(refs_.size() - first == cell.count);
    std::sort(refs_.begin() + static_cast<std::ptrdiff_t>(first), refs_.end());
    for (std::size_t axis = 0; axis < 3; ++axis) stacks_[axis].pop(cell.begin[axis]);
    return KdNode::leaf(static_cast<std::uint32_t>(first), cell.count);
  }

 private:
  /// What the leaves of a cell that is to be built next may list; never less than its count.
  std::uint64_t refs_left(const Cell& cell) const { return cell.max_refs - refs_.size(); }

  /// The plane of smallest cost strictly inside the cell; cost is infinite where there is none.
  Plane cheapest_plane(const Cell& cell) const {
    Plane best;
    if (cell.count == 0 || cell.depth >= max_depth_) return best;
    if (node_count_ + 2 > kMaxNodes) return best;
    for (std::size_t axis = 0; axis < 3; ++axis) sweep(cell, axis, best);
    return best;
  }

  /// Moves a plane along the axis, counting what starts and ends on the way.
  void sweep(const Cell& cell, std::size_t axis, Plane& best) const {
    const std::span<const KdEvent> events = stacks_[axis].top(cell.begin[axis]);
    const SliceOdds odds(config_.area, cell.box, axis);
    const float lo = cell.box.lo[axis], hi = cell.box.hi[axis];
    const std::uint64_t refs_left = this->refs_left(cell);
    std::uint32_t below = 0, above = cell.count;
    for (std::size_t i = 0; i < events.size();) {
      const float position = events[i].position;
      std::array<std::uint32_t, 3> here{};
      for (; i < events.size() && events[i].position == position; ++i) ++here[events[i].type()];
      const std::uint32_t planar = here[KdEvent::kPlanar];
      above -= planar + here[KdEvent::kEnd];
      if (lo < position && position < hi && std::uint64_t{below} + above + planar <= refs_left) {
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

  static void consider(const Plane& candidate, Plane& best) {
    if (candidate.cost < best.cost) best = candidate;
  }

  /// Sets `sides_` for every item of the cell. An item's start comes before its end in the list.
  void choose_sides(const Cell& cell, const Plane& plane) {
    for (const KdEvent& event : stacks_[plane.axis].top(cell.begin[plane.axis])) {
      KdSides& side = sides_[event.item()];
      if (event.type() == KdEvent::kStart)
        side = event.position >= plane.position ? kAbove : kBoth;
      else if (event.position < plane.position)
        side = kBelow;
      else if (event.type() == KdEvent::kPlanar)
        side = event.position > plane.position ? kAbove : plane.planar_side;
      else if (event.position == plane.position)
        side = kBelow;
    }
  }

  KdBuildConfig config_;
  std::uint32_t ref_base_, max_depth_;
  std::array<KdEventStack, 3> stacks_;
  std::vector<KdSides> sides_;
  std::vector<std::uint32_t> refs_;
  std::size_t node_count_ = 1;
};

/// Cost of the subtree at `index` for a ray that hits `cell`.
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
  KdSplitter splitter(boxes, ref_base, config, depth_limit(config.max_depth, count));
  KdTree tree;
  tree.bounds = bounds;
  tree.nodes =
      build_top_down<KdNode>(splitter, Cell{bounds, {}, count, 0, kMaxRefsPerItem * count}, 1);
  tree.refs = splitter.take_refs();
  assert(validate(tree.view(), boxes, ref_base).empty());
  return tree;
}

double sah_cost(const KdTreeView& tree, const KdBuildConfig& config) {
  return expected_cost(tree, config, 0, tree.bounds);
}

}  // namespace mdk
