// SAH kd-trees over boxes by sorted event sweeps, O(N log N) (Wald and Havran 2006; surface area
// heuristic: MacDonald and Booth 1989). Boxes are clipped to the cell as the recursion descends.
#pragma once

#include <span>

#include "common/math/aabb.h"
#include "common/structures/kd_tree.h"

namespace mdk {

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

/// A tree whose leaves refer to `ref_base` + index into `boxes`. Every point of a box lies in the
/// closed cell of a leaf that lists it; a tree lists at most 8 references per box. Bounds: the
/// union of the boxes. Boxes must be finite; empty ones are left out. With no boxes: one empty
/// leaf. The result depends on the input alone. Throws Error (kOverLimit) past 2^27 boxes. Cost:
/// O(N log N).
KdTree build_kd_tree(std::span<const Aabb> boxes, std::uint32_t ref_base = 0,
                     const KdBuildConfig& config = {});

/// Expected cost of a ray that meets the tree's bounds, in the config's units (SAH).
double sah_cost(const KdTreeView& tree, const KdBuildConfig& config);

}  // namespace mdk
