// From the decomposition's parts to the model: triangles sorted by cluster, boxes, fuzzy kd-trees.
#pragma once

#include "common/base/parallel.h"
#include "common/motion/model.h"
#include "common/motion/pose_sequence.h"
#include "preprocess/decomposition.h"

namespace mdk {

struct AssembledModel {
  ModelStorage model;
  double expected_work = 0;  ///< of a ray that hits the model, mean over time (cost.h)
};

/// What the cost (cost.h) expects of a finished model: AssembledModel::expected_work, but for the
/// rounding of the boxes of poses. Cost: O(boxes and maps).
double predicted_cost(const ModelView& model);

/// Whether the model of a sequence keeps its rig: where there is one that takes less room than the
/// positions.
bool rig_is_smallest(const PoseSequence& sequence);

/// Consumes the sequence, whose vertices stand in cluster_order, and its decomposition, whose parts
/// are all there. Reports stage "build"; `boxes_until`: share of the work after which trees are
/// built. Throws Error (kOverLimit) where the trees outgrow 32-bit links.
AssembledModel assemble_model(PoseSequence sequence, Decomposition decomposition,
                              double boxes_until, ProgressSink& progress);

}  // namespace mdk
