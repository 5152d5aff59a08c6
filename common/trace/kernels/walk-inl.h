// The one way down a tree. A tile, a beam and a ray differ in what they carry (`Rays`: their bounds
// in the tree's basis, and how far they have come), not in how they descend. Levels nest: a leaf
// of an outer walk may begin an inner one, with rays of its own basis.
//
//     rays.enter(node, order)   the children that may be hit, a bit each, and for each a number
//                               that grows with where its box begins
//     rays.expect(child)        may fetch what a child that is entered needs; need not be there
//     rays.is_past(order)       nothing that begins there matters any more
//     rays.misses(cell)         certainly; a Cell is a node of a kd-tree and its box
//     rays.set_axis(cell, axis, lo, hi)
//     rays.below_first(axis, split)   whether what is below the plane comes first
//     rays.finished()           no ray is left that could hit anything
#include <span>
#include <vector>

#include "common/simd/boxes-inl.h"
#include "common/structures/kd_tree.h"
#include "common/structures/wide_bvh.h"

#if defined(MDK_WALK_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MDK_WALK_INL_H_
#undef MDK_WALK_INL_H_
#else
#define MDK_WALK_INL_H_
#endif

HWY_BEFORE_NAMESPACE();
namespace mdk {
namespace HWY_NAMESPACE {

/// A child that waits for its turn.
struct WaitingChild {
  float order;
  WideBvhChild child;
};

/// Calls leaf(number) for the leaves entered, near ones first.
template <std::uint32_t kWidth, class Rays, class Leaf>
HWY_INLINE void walk_bvh(std::span<const WideNode<kWidth>> nodes, Rays& rays, const Leaf& leaf) {
  if (nodes.empty()) return;
  // Every level leaves all but one child on the stack.
  WaitingChild stack[std::size_t{kMaxBvhDepth + 1} * kWidth];
  std::size_t size = 0;
  const auto open = [&](const WideNode<kWidth>& node) {
    alignas(64) float order[kWidth];
    const std::size_t bottom = size;
    for (std::uint32_t entered = rays.enter(node, order); entered != 0; entered &= entered - 1) {
      const auto c = static_cast<std::size_t>(__builtin_ctz(entered));
      const WaitingChild child{order[c], node.child[c]};
      if constexpr (requires { rays.expect(child.child); }) rays.expect(child.child);
      std::size_t at = size++;  // the nearest comes on top
      for (; at > bottom && stack[at - 1].order < child.order; --at) stack[at] = stack[at - 1];
      stack[at] = child;
    }
  };
  open(nodes[0]);
  while (size > 0) {
    const WaitingChild next = stack[--size];
    if (rays.is_past(next.order)) continue;
    if (!next.child.is_leaf()) {
      open(nodes[next.child.index()]);
      continue;
    }
    leaf(next.child.index());
    if (rays.finished()) return;
  }
}

template <class Rays>
HWY_INLINE typename Rays::Cell root_cell(const Rays& rays, const Aabb& bounds) {
  typename Rays::Cell cell;
  cell.node = 0;
  for (std::size_t axis = 0; axis < 3; ++axis)
    rays.set_axis(cell, axis, bounds.lo[axis], bounds.hi[axis]);
  return cell;
}

/// Calls leaf(reference) for what stands in the leaves entered, near leaves first. The cell shrinks
/// on the way down, and is tested whole (inverse frustum culling, RSH05).
template <class Rays, class Leaf>
HWY_INLINE void walk_kd(const KdTreeView& tree, Rays& rays, const Leaf& leaf) {
  if (tree.nodes.empty()) return;
  typename Rays::Cell stack[kMaxKdDepth + 2];
  std::size_t size = 0;
  stack[size++] = root_cell(rays, tree.bounds);
  while (size > 0 && !rays.finished()) {
    typename Rays::Cell& cell = stack[size - 1];
    if (rays.misses(cell)) {
      --size;
      continue;
    }
    const KdNode node = tree.nodes[cell.node];
    if (node.is_leaf()) {
      --size;
      for (std::uint32_t i = 0; i < node.ref_count(); ++i) leaf(tree.refs[node.first_ref() + i]);
      continue;
    }
    // The far child takes the cell's place, the near one comes on top of it.
    const std::uint32_t axis = node.axis();
    const bool below_first = rays.below_first(axis, node.split());
    typename Rays::Cell& next = stack[size++] = cell;
    typename Rays::Cell& below = below_first ? next : cell;
    typename Rays::Cell& above = below_first ? cell : next;
    below.node = node.below();
    above.node = node.above();
    rays.set_axis(below, axis, below.lo[axis], node.split());
    rays.set_axis(above, axis, node.split(), above.hi[axis]);
  }
}

/// Lets each item pass once per tile or beam, however many leaves of a kd-tree hold it: a stamp per
/// item says in which it was last seen.
class Mailbox {
 public:
  Mailbox(std::vector<std::uint32_t>& stamps, std::uint32_t serial)
      : stamps_(stamps.data()), serial_(serial) {}
  bool is_new(std::uint32_t item) {
    if (stamps_[item] == serial_) return false;
    stamps_[item] = serial_;
    return true;
  }

 private:
  std::uint32_t* stamps_;
  std::uint32_t serial_;
};

}  // namespace HWY_NAMESPACE
}  // namespace mdk
HWY_AFTER_NAMESPACE();

#endif  // per-target guard
