// From the decomposition's parts to the model: triangles sorted by cluster, boxes, fuzzy kd-trees.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/base/progress.h"
#include "common/motion/model.h"
#include "common/motion/pose_sequence.h"
#include "preprocess/cluster_members.h"

namespace mdk {

/// What was decided about a sequence, besides its clusters.
struct ModelParts {
  std::vector<Affine3f> local_from_world;  ///< F * K, key-major
  std::vector<Segment> segments;
  std::uint32_t rest_key = 0;

  std::vector<ClusterBone> cluster_bones;   ///< K where a pose space is bounded, else none
  std::vector<Aabb> pose_space_boxes;       ///< T then, in the order of the clusters' triangles
  std::optional<QuantizedPoses> quantized;  ///< what the sequence's positions were decoded from

  double boxes_until = 0.4;  ///< share of the assembly after which trees are built, for progress
};

struct AssembledModel {
  ModelStorage model;
  double expected_work = 0;  ///< of a ray that meets the model, mean over time (cost.h)
};

/// Whether the model of a sequence keeps its rig: where there is one that takes less room than the
/// positions.
bool rig_is_smallest(const PoseSequence& sequence);

/// Consumes the sequence, whose vertices stand in cluster_order, and the parts. Reports stage
/// "build". Throws Error (kOverLimit) where the trees outgrow 32-bit links.
AssembledModel assemble_model(PoseSequence sequence, const ClusterMembers& members,
                              ModelParts parts, ProgressSink& progress);

}  // namespace mdk
