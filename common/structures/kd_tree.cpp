// Checking a kd-tree: first what a walk over it relies on, in one forward pass over the nodes;
// then, where the boxes are known, that each of them is found wherever it is, by handing its parts
// down to the leaves.
#include "common/structures/kd_tree.h"

#include <algorithm>
#include <cmath>

#include "common/structures/link_check.h"

namespace mdk {
namespace {

/// What is known of a tree whose links are sound.
class ContentCheck {
 public:
  ContentCheck(const KdTreeView& tree, std::span<const Aabb> boxes, std::uint32_t ref_base)
      : tree_(tree), boxes_(boxes), ref_base_(ref_base) {}

  std::string run() const {
    Aabb bounds;
    for (const Aabb& box : boxes_) bounds.extend(box);
    if (tree_.bounds != bounds) return "the bounds are not the union of the boxes";
    if (std::string fault = fault_of_cell(0, bounds); !fault.empty()) return fault;
    for (std::uint32_t item = 0; item < boxes_.size(); ++item)
      if (!boxes_[item].empty() && !is_covered(0, boxes_[item], item))
        return "box " + std::to_string(item) + " is not listed everywhere it is";
    return "";
  }

 private:
  std::span<const std::uint32_t> refs_of(const KdNode& leaf) const {
    return tree_.refs.subspan(leaf.first_ref(), leaf.ref_count());
  }

  std::string fault_of_cell(std::uint32_t index, const Aabb& cell) const {
    const KdNode& node = tree_.nodes[index];
    const std::string at = "node " + std::to_string(index) + ": ";
    if (node.is_leaf()) {
      std::vector<std::uint32_t> refs(refs_of(node).begin(), refs_of(node).end());
      std::sort(refs.begin(), refs.end());
      if (std::adjacent_find(refs.begin(), refs.end()) != refs.end())
        return at + "a leaf lists a box twice";
      for (const std::uint32_t ref : refs)
        if (intersection(boxes_[ref - ref_base_], cell).empty())
          return at + "box " + std::to_string(ref - ref_base_) + " does not touch the cell";
      return "";
    }
    const std::size_t axis = node.axis();
    if (!(cell.lo[axis] < node.split() && node.split() < cell.hi[axis]))
      return at + "the split is not inside the cell";
    Aabb below = cell, above = cell;
    below.hi[axis] = above.lo[axis] = node.split();
    const std::string fault = fault_of_cell(node.below(), below);
    return fault.empty() ? fault_of_cell(node.above(), above) : fault;
  }

  /// Whether the leaves under a node, whose cell holds it, list all of a part of a box.
  bool is_covered(std::uint32_t index, const Aabb& part, std::uint32_t item) const {
    const KdNode& node = tree_.nodes[index];
    if (node.is_leaf()) {
      const auto refs = refs_of(node);
      return std::find(refs.begin(), refs.end(), ref_base_ + item) != refs.end();
    }
    const std::size_t axis = node.axis();
    const float lo = part.lo[axis], hi = part.hi[axis], split = node.split();
    if (lo == split && hi == split)  // what lies in the plane may be on either side
      return is_covered(node.below(), part, item) || is_covered(node.above(), part, item);
    Aabb below = part, above = part;
    below.hi[axis] = std::min(hi, split);
    above.lo[axis] = std::max(lo, split);
    return (!(lo < split) || is_covered(node.below(), below, item)) &&
           (!(hi > split) || is_covered(node.above(), above, item));
  }

  KdTreeView tree_;
  std::span<const Aabb> boxes_;
  std::uint32_t ref_base_;
};

}  // namespace

std::string validate(const KdTreeView& tree, std::uint32_t ref_begin, std::uint32_t ref_end) {
  if (tree.nodes.empty()) return "no nodes";
  for (const std::uint32_t ref : tree.refs)
    if (ref < ref_begin || ref >= ref_end)
      return "a reference to " + std::to_string(ref) + ", which there is not";
  LinkCheck nodes("node", tree.nodes.size(), kMaxKdDepth);
  nodes.reach(0);
  std::uint64_t listed = 0;
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    const KdNode& node = tree.nodes[i];
    std::string fault;
    if (!nodes.is_reached(i)) {
      fault = "no node before it links to it";
    } else if (node.is_leaf()) {
      const std::uint64_t run_end = std::uint64_t{node.first_ref()} + node.ref_count();
      if (run_end > tree.refs.size()) fault = "a leaf past the end of the references";
      listed += node.ref_count();
    } else {
      if (!std::isfinite(node.split())) fault = "a split that is not finite";
      for (const std::uint32_t child : {node.below(), node.above()})
        if (fault.empty()) fault = nodes.reach(child, nodes.depth(i) + 1);
    }
    if (!fault.empty()) return nodes.name(i) + ": " + fault;
  }
  // Runs that overlap could make a small file an endless walk.
  return listed <= tree.refs.size() ? "" : "leaves list more references than there are";
}

std::string validate(const KdTreeView& tree, std::span<const Aabb> boxes, std::uint32_t ref_base) {
  const auto ref_end = static_cast<std::uint32_t>(ref_base + boxes.size());
  const std::string fault = validate(tree, ref_base, ref_end);
  return fault.empty() ? ContentCheck(tree, boxes, ref_base).run() : fault;
}

}  // namespace mdk
