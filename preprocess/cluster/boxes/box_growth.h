// How many clusters: from one, all clusters that pay are cut at once, relaxed, and those that no
// longer pay are dissolved, until the cost stays.
#pragma once

#include <cstdint>

#include "common/base/progress.h"
#include "common/motion/pose_sequence.h"
#include "preprocess/decomposition.h"
#include "preprocess/options.h"

namespace mdk {

/// Clusters by the cost of tracing their boxes. Grown on a farthest-point sample of the keys, and
/// of the triangles of large meshes; then on all triangles and as many keys as a work budget
/// allows. `unit`: see pose_unit; `request.stop_percent` counts for nothing. There must be as many
/// triangles as clusters are requested.
Growth cluster_by_boxes(const PoseSequence& sequence, const ClusterRequest& request, double unit,
                        ProgressSink& progress);

}  // namespace mdk
