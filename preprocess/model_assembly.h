// From the decomposition's parts to the model: triangles sorted by cluster, boxes, fuzzy kd-trees.
#pragma once

#include <cstdint>
#include <vector>

#include "common/base/progress.h"
#include "common/motion/model.h"
#include "common/motion/pose_sequence.h"
#include "preprocess/cluster_members.h"
#include "preprocess/cost.h"
#include "preprocess/key_maps.h"

namespace mdk {

struct AssembledModel {
  ModelStorage model;
  std::vector<ClusterWork> work;  ///< K: the cost's view of the finished clusters
};

/// Consumes the sequence and the maps. Reports stage "build".
AssembledModel assemble_model(PoseSequence sequence, const ClusterMembers& members, KeyMaps maps,
                              std::uint32_t rest_key, ProgressSink& progress);

}  // namespace mdk
