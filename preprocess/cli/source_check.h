// Does a .mdk still say what its source says?
#pragma once

#include <vector>

#include "common/motion/model.h"
#include "common/motion/pose_sequence.h"
#include "preprocess/cli/check_result.h"

namespace mdk {

/// Compares clips, key times and triangles with the source read again, and the position of every
/// triangle's corner at every key: positions are stored as they were read, so each difference is a
/// failure. `detail` gives the largest one, relative to the rest pose's diagonal. Where the shapes
/// do not fit together, positions are left out.
std::vector<CheckResult> check_source(const Model& model, const PoseSequence& source);

}  // namespace mdk
