// KdTree: 8-byte nodes, leaves as runs in one list of references. The same form serves fuzzy trees,
// static trees of one pose, and the top level over clusters.
#pragma once

#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "common/math/aabb.h"

namespace mdk {

/// Deepest leaf a tree may have (root: 0). Traversal stacks are this long.
inline constexpr std::uint32_t kMaxKdDepth = 60;

/// Inner node: the plane x[axis] = split; children stand side by side, `below` first. What lies in
/// the plane belongs to both. Leaf: a run of references.
///
///     word1 bits 0-1: axis 0, 1, 2, or 3 for a leaf;  bits 2-31: left child | reference count
///     word0: the split as float bits               |  first reference
struct KdNode {
  std::uint32_t word0 = 0, word1 = 3;

  static KdNode leaf(std::uint32_t first_ref, std::uint32_t count) {
    return {first_ref, (count << 2) | 3u};
  }
  static KdNode inner(std::uint32_t axis, float split, std::uint32_t below_child) {
    return {std::bit_cast<std::uint32_t>(split), (below_child << 2) | axis};
  }

  bool is_leaf() const { return (word1 & 3u) == 3u; }
  std::uint32_t axis() const { return word1 & 3u; }
  float split() const { return std::bit_cast<float>(word0); }
  std::uint32_t below() const { return word1 >> 2; }
  std::uint32_t above() const { return (word1 >> 2) + 1; }
  std::uint32_t first_ref() const { return word0; }
  std::uint32_t ref_count() const { return word1 >> 2; }
};
static_assert(sizeof(KdNode) == 8);

/// Node 0 is the root; every child has a higher index than its parent and one parent only.
struct KdTreeView {
  std::span<const KdNode> nodes;
  std::span<const std::uint32_t> refs;
  Aabb bounds;
};

struct KdTree {
  std::vector<KdNode> nodes;
  std::vector<std::uint32_t> refs;
  Aabb bounds;

  KdTreeView view() const { return {nodes, refs, bounds}; }
  std::size_t bytes() const {
    return nodes.size() * sizeof(KdNode) + refs.size() * sizeof(std::uint32_t);
  }
};

/// Whether a tree from outside can be walked blindly: links forward and each node reached once,
/// depth within kMaxKdDepth, reference runs inside `refs` and together no longer than it, each
/// reference in [ref_begin, ref_end), splits finite. Cost: O(nodes + refs).
bool is_well_formed(const KdTreeView& tree, std::uint32_t ref_begin, std::uint32_t ref_end);

}  // namespace mdk
