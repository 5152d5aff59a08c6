// Local bases: a rotation per cluster that makes its triangles' fuzzy boxes small (GFW06 §3.4). Any
// rotation can be folded into the maps; PCA of the fuzzy positions proposes, the summed world area
// of the fuzzy boxes decides. The origin is the middle of the cluster, where numbers are small. A
// finished cluster gets a better basis than its principal axes by a pattern search over rotations.
#pragma once

#include <span>
#include <vector>

#include "common/math/affine3.h"
#include "preprocess/boxes/cost.h"
#include "preprocess/decomposition.h"
#include "preprocess/maps/cluster_points.h"
#include "preprocess/pose/pose_table.h"

namespace mdk {

struct LocalFrames {
  std::vector<Affine3d> local_from_rest;  ///< K: rigid, in table coordinates
  std::vector<ClusterWork> clusters;      ///< K: the cost's view of the clusters in these bases
};

/// Chooses between the axes as they are and the principal axes of the fuzzy positions. `maps`: K *
/// R, cluster-major, row's pose to rest pose, in table coordinates. Cost: O(rows * vertices).
LocalFrames choose_local_frames(const PoseTable& table, const ClusterMembers& members,
                                std::span<const Affine3d> maps);

/// Fuzzy boxes of a cluster under some maps: summed mean area in units of the model's.
/// `maps`: R, from centred row coordinates; `model_areas`: R. Cost: O(rows * vertices).
double fuzzy_area(const ClusterPoints& points, std::span<const Affine3d> maps,
                  std::span<const double> model_areas);

/// The maps, followed by the rotation that makes the boxes smallest; as they are where none was
/// found. Searched on up to 32 rows, judged on all. Cost: O(32 * vertices), some fifty times.
std::vector<Affine3d> turned_to_small_boxes(const ClusterPoints& points,
                                            std::span<const Affine3d> maps,
                                            std::span<const double> model_areas);

}  // namespace mdk
