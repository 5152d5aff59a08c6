// Bvh: a binary bounding volume hierarchy with 32-byte nodes, built by binned SAH and kept valid by
// refitting.
#pragma once

#include <cstdint>
#include <span>
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

  bool is_leaf() const { return count != 0; }
  Aabb box() const { return {lo, hi}; }
  void set_box(const Aabb& b) {
    lo = b.lo;
    hi = b.hi;
  }
};
static_assert(sizeof(BvhNode) == 32);

/// Node 0 is the root; every child has a higher index than its parent. No items: no nodes.
struct Bvh {
  std::vector<BvhNode> nodes;
  std::vector<std::uint32_t> refs;

  std::size_t bytes() const {
    return nodes.size() * sizeof(BvhNode) + refs.size() * sizeof(std::uint32_t);
  }
};

struct BvhBuildConfig {
  int bins = 16;  ///< 2 to 1024, per axis
  float traversal_cost = 1.0f;
  float intersect_cost = 1.0f;
  std::uint32_t max_leaf = 8;  ///< most references in a leaf, 1 to 4096
  std::uint32_t block = 1;     ///< items tested together: one test's cost for so many, or fewer
};

/// Binned SAH over box centroids (Wald 2007; Lo09 §4.1). Where bins cannot tell items apart, or
/// would dig past kMaxBvhDepth, or where areas are past the range of float, a node is halved
/// instead. Boxes must be finite and not empty, fewer than 2^29. Cost: O(N log N); runs in
/// parallel. The result depends on the input alone.
Bvh build_bvh(std::span<const Aabb> boxes, const BvhBuildConfig& config = {});

/// New boxes for the same items, bottom up (Lo09 §4.2). `boxes` has one per item, as in the build.
/// Cost: O(N).
void refit_bvh(Bvh& bvh, std::span<const Aabb> boxes);

/// Expected cost of a ray that meets the root's box (SAH). A root without area counts as met whole.
double sah_cost(const Bvh& bvh, const BvhBuildConfig& config);

}  // namespace mdk
