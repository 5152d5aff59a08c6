// How the time of a decomposition divides among its stages, predicted from the size of the input:
// so that progress rises evenly, and the time left is about right long before the end. What is
// shown depends on it, no result does.
#pragma once

#include "common/motion/pose_sequence.h"
#include "preprocess/pipeline.h"

namespace mdk {

/// Where each stage ends, as a share of the whole, in this order; after `boxed` the fuzzy kd-trees
/// are built.
struct StageEnds {
  double clustered = 0, mapped = 0, segmented = 0, boxed = 0;
};

StageEnds predict_stage_ends(const PoseSequence& sequence, const DecomposeOptions& options);

}  // namespace mdk
