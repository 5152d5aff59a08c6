// KdTree: 8-byte nodes, leaves as runs in one list of references; built over boxes by the surface
// area heuristic (MacDonald and Booth 1989) with sorted event sweeps (Wald and Havran 2006). The
// same form serves fuzzy trees, static trees of one pose, and the top level over clusters.
#pragma once

#include <bit>
#include <cstdint>
#include <span>
#include <string>
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

/// Area of a box as the rays see it: 2 (xy ex ey + yz ey ez + zx ez ex). Ones give the plain
/// surface area; a cluster's basis stretches its axes unevenly, which its weights undo
/// (docs/method.md, cost).
struct AreaWeights {
  double xy = 1, yz = 1, zx = 1;

  AreaWeights operator*(double f) const { return {xy * f, yz * f, zx * f}; }
  double area(const Vec3d& extent) const {
    return 2 * (xy * extent.x * extent.y + yz * extent.y * extent.z + zx * extent.z * extent.x);
  }
};

struct KdBuildConfig {
  float traversal_cost = 1.0f;  ///< of one step, in units of...
  float intersect_cost = 1.5f;  ///< ...one item's test being this much
  float empty_bonus = 0.8f;     ///< factor on the cost of a split that cuts off empty space
  std::uint32_t max_depth = 0;  ///< 0: 8 + 1.3 log2 N; never past kMaxKdDepth
  AreaWeights area{};
};

/// What a triangle's test costs in traversal steps. Low, because a tile tests a leaf's triangles
/// sixteen at a time and knows those it tested in other leaves. Where the trace times of fuzzy and
/// static trees together were least (docs/method.md, techniques).
inline constexpr float kKdTestCost = 0.05f;

/// Of every tree over triangles: the fuzzy ones in files and the static ones of single poses are
/// built alike, so that the two compare.
inline constexpr KdBuildConfig kTriangleTreeConfig{.intersect_cost = kKdTestCost};

/// A tree whose leaves refer to `ref_base` + index into `boxes`. Every point of a box lies in the
/// closed cell of a leaf that lists it; a tree lists at most 8 references per box. Bounds: the
/// union of the boxes. Boxes must be finite; empty ones are left out. With no boxes: one empty
/// leaf. The result depends on the input alone. Throws Error (kOverLimit) past 2^27 boxes. Cost:
/// O(N log N).
KdTree build_kd_tree(std::span<const Aabb> boxes, std::uint32_t ref_base = 0,
                     const KdBuildConfig& config = {});

/// Expected cost of a ray that hits the tree's bounds, in the config's units (SAH).
double sah_cost(const KdTreeView& tree, const KdBuildConfig& config);

/// The first reason why a tree from outside cannot be walked blindly, in words; empty where there
/// is none. Sound: links forward and each node reached once, depth within kMaxKdDepth, reference
/// runs inside `refs` and together no longer than it, each reference in [ref_begin, ref_end),
/// splits finite. Cost: O(nodes + refs).
std::string validate(const KdTreeView& tree, std::uint32_t ref_begin, std::uint32_t ref_end);

/// The same, and whether it is a tree over `boxes`, as build_kd_tree() makes one: bounds are their
/// union, splits lie strictly inside their cells, which therefore partition the bounds; a leaf
/// lists no box that its closed cell does not touch, and none twice; every point of a box lies in
/// the closed cell of a leaf that lists it, and so every cell a box enters has it. Cost: O(levels *
/// refs) and the square of what a leaf lists.
std::string validate(const KdTreeView& tree, std::span<const Aabb> boxes,
                     std::uint32_t ref_base = 0);

}  // namespace mdk
