// The sample mesh read and decomposed in memory, for tests that bend a model on purpose.
#pragma once

#include "common/motion/model.h"
#include "common/motion/pose_sequence.h"

namespace mdk::test {

PoseSequence sample_sequence();

/// Three clusters of the sample.
ModelStorage sample_model();

}  // namespace mdk::test
