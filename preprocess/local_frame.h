// Local bases: a rotation per cluster that makes its triangles' fuzzy boxes small (GFW06 §3.4). Any
// rotation can be folded into the maps; PCA of the fuzzy positions proposes, the summed world area
// of the fuzzy boxes decides. The origin is the middle of the cluster, where numbers are small.
#pragma once

#include <span>
#include <vector>

#include "common/math/affine3.h"
#include "preprocess/cluster_members.h"
#include "preprocess/cost.h"
#include "preprocess/pose_table.h"

namespace mdk {

struct LocalFrames {
  std::vector<Affine3d> local_from_rest;  ///< K: rigid, in table coordinates
  std::vector<ClusterWork> clusters;      ///< K: the cost's view of the clusters in these bases
};

/// Area of the model's box in each row, table units.
std::vector<double> model_box_areas(const PoseTable& table);

/// Chooses between the axes as they are and the principal axes of the fuzzy positions. `maps`: K *
/// R, cluster-major, row's pose to rest pose, in table coordinates. Cost: O(rows * vertices).
LocalFrames choose_local_frames(const PoseTable& table, const ClusterMembers& members,
                                std::span<const Affine3d> maps, const CostOptions& options);

}  // namespace mdk
