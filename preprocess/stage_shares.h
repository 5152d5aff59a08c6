// How the time of a decomposition divides among its stages, predicted from the size of the input:
// so that progress rises evenly, and the time left is about right long before the end. What is
// shown depends on it, no result does.
#pragma once

#include "preprocess/pipeline.h"

namespace mdk {

/// How large a sequence is, or is taken to be before it is read.
struct SequenceSize {
  double positions = 0;  ///< keys times vertices
  double triangles = 0;
};

/// Of a decomposition, on one core of a common machine. Only ratios count.
double predict_decompose_seconds(const SequenceSize& size, const DecomposeOptions& options);

/// Where each stage ends, as a share of the whole, in this order; after `boxed` the fuzzy kd-trees
/// are built.
struct StageEnds {
  double clustered = 0, mapped = 0, ordered = 0, segmented = 0, boxed = 0;
};

StageEnds predict_stage_ends(const SequenceSize& size, const DecomposeOptions& options);

}  // namespace mdk
