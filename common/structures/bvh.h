// Bvh: a binary bounding volume hierarchy with 32-byte nodes, built top down by the surface area
// heuristic, over boxes as they are or over boxes that move. What is traced is a WideBvh made of
// one.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/math/aabb.h"

namespace mdk {

/// Deepest leaf a hierarchy may have (root: 0). Traversal stacks are this long.
inline constexpr std::uint32_t kMaxBvhDepth = 96;

/// count == 0: inner, children at `first` and `first` + 1; else a leaf of `count` references from
/// `first`.
struct BvhNode {
  Vec3f lo;
  std::uint32_t first = 0;
  Vec3f hi;
  std::uint32_t count = 0;

  static BvhNode leaf(const Aabb& box, std::uint32_t first, std::uint32_t count) {
    return {box.lo, first, box.hi, count};
  }
  static BvhNode inner(const Aabb& box, std::uint32_t children) {
    return {box.lo, children, box.hi, 0};
  }

  bool is_leaf() const { return count != 0; }
  Aabb box() const { return {lo, hi}; }
};
static_assert(sizeof(BvhNode) == 32);

/// Node 0 is the root; every child has a higher index than its parent. No items: no nodes.
struct Bvh {
  std::vector<BvhNode> nodes;
  std::vector<std::uint32_t> refs;
};

struct BvhBuildConfig {
  int bins = 16;  ///< 2 to 1024, per axis
  float traversal_cost = 1.0f;
  float intersect_cost = 1.0f;
  std::uint32_t max_leaf = 8;  ///< most references in a leaf, 1 to 4096
  std::uint32_t block = 1;     ///< items tested together: one test's cost for so many, or fewer

  /// Tests of a block that a leaf of `count` items takes.
  float leaf_tests(std::uint32_t count) const {
    return static_cast<float>((count + block - 1) / block);
  }
};

/// Binned SAH over box centroids (Wald 2007; Lo09 §4.1). Where bins cannot tell items apart, or
/// would dig past kMaxBvhDepth, or where areas are past the range of float, a node is halved
/// instead. Boxes must be finite and not empty, fewer than 2^29. Cost: O(N log N); runs in
/// parallel. The result depends on the input alone.
Bvh build_bvh(std::span<const Aabb> boxes, const BvhBuildConfig& config = {});

/// A hierarchy for boxes that move, built for the SAH summed over several poses (T-SAH, Bittner and
/// Meister 2015), so that refitting it serves all of them well. `boxes`: those of N items in each
/// of `poses` poses, pose after pose; finite, none empty. Each pose counts alike: areas are
/// relative to its root's. Splits are sought among the centroids of several poses. The nodes hold
/// their boxes in the first pose. Uses config.bins (at most 64) and its costs. Cost: O(poses * N
/// log N). The result depends on the input alone.
Bvh build_temporal_bvh(std::span<const Aabb> boxes, std::uint32_t poses,
                       const BvhBuildConfig& config);

/// The first fault found in a hierarchy over `boxes`, in words; empty where there is none. Sound:
/// every node is reached once, from a node before it, none deeper than kMaxBvhDepth; every item is
/// in one leaf, and leaves have at most `max_leaf`; each box is the union of what is under it.
/// Cost: O(N).
std::string validate(const Bvh& bvh, std::span<const Aabb> boxes, std::uint32_t max_leaf);

}  // namespace mdk
