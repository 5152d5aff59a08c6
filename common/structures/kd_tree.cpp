// What a walk over a kd-tree relies on, checked in one forward pass: links point forward, so a
// node's depth is known before the node is looked at.
#include "common/structures/kd_tree.h"

#include <cmath>

namespace mdk {
namespace {

constexpr std::uint8_t kNotReached = 0xff;
static_assert(kMaxKdDepth < kNotReached);

/// Gives both children of an inner node their depth; false where a link or the split is not usable.
bool reach_children(const KdNode& node, std::size_t index, std::vector<std::uint8_t>& depths) {
  const std::size_t below = node.below();
  if (!std::isfinite(node.split())) return false;
  if (below + 1 >= depths.size()) return false;
  if (depths[index] == kMaxKdDepth) return false;
  // Up to `index` all nodes are reached, so this refuses links that do not point forward, too.
  for (const std::size_t child : {below, below + 1}) {
    if (depths[child] != kNotReached) return false;
    depths[child] = static_cast<std::uint8_t>(depths[index] + 1);
  }
  return true;
}

}  // namespace

bool is_well_formed(const KdTreeView& tree, std::uint32_t ref_begin, std::uint32_t ref_end) {
  if (tree.nodes.empty()) return false;
  for (const std::uint32_t ref : tree.refs)
    if (ref < ref_begin || ref >= ref_end) return false;

  std::vector<std::uint8_t> depths(tree.nodes.size(), kNotReached);
  depths[0] = 0;
  std::uint64_t listed = 0;
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    const KdNode& node = tree.nodes[i];
    if (depths[i] == kNotReached) return false;
    if (!node.is_leaf()) {
      if (!reach_children(node, i, depths)) return false;
      continue;
    }
    const std::uint64_t run_end = std::uint64_t{node.first_ref()} + node.ref_count();
    if (run_end > tree.refs.size()) return false;
    listed += node.ref_count();
  }
  // Runs that overlap could make a small file an endless walk.
  return listed <= tree.refs.size();
}

}  // namespace mdk
