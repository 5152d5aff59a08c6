// The ways to clusters: by the cost of tracing their boxes, as in GFW06 by residual motion, and one
// for each bone of a rig.
#pragma once

#include <cstdint>
#include <vector>

#include "common/base/parallel.h"
#include "common/math/affine3.h"
#include "common/motion/pose_sequence.h"
#include "preprocess/decomposition.h"
#include "preprocess/options.h"
#include "preprocess/pose/pose_space.h"
#include "preprocess/pose/pose_table.h"

namespace mdk {

/// Clusters by the cost of tracing their boxes. Grown on a farthest-point sample of the keys, and
/// of the triangles of large meshes; then on all triangles and as many keys as a work budget
/// allows. `unit`: see pose_unit; `request.stop_percent` counts for nothing. There must be as many
/// triangles as clusters are requested.
Growth cluster_by_boxes(const PoseSequence& sequence, const ClusterRequest& request, double unit,
                        ProgressSink& progress);

/// Clusters with the principal axes of their residual motion as local bases.
struct PaperClusters : Growth {
  std::vector<Affine3d> local_from_rest;  ///< K: see LocalFrames
};

/// Grown on a farthest-point sample of the keys, then relaxed on as many as a work budget allows;
/// the rest pose is searched again among all keys at the end. `unit`: see pose_unit.
PaperClusters cluster_by_residuals(const PoseSequence& sequence, const ClusterRequest& request,
                                   double unit, ProgressSink& progress);

struct BoneClusters : Assignment {
  std::vector<std::uint32_t> bones;  ///< K, rising: the bone of each cluster; each has triangles
};

/// Judges boxes over the keys of the table, in all bones' bases; or, where there is one, over a
/// pose space, too, in those of the bones that move a corner. The sequence has a rig. Cost: at most
/// O(bones * rows * vertices), mostly O(bones * vertices).
BoneClusters assign_to_bones(const PoseSequence& sequence, const PoseTable& table,
                             const PoseSpace* space);

}  // namespace mdk
