// Real sequences for tests that measure quality; absent where the sample data is not installed.
#pragma once

#include <optional>
#include <string>

#include "common/motion/pose_sequence.h"

namespace mdk {

/// NAME.obj for the triangles (faces of any size, fanned) and NAME.pc2 for the poses, from the
/// folder "sequences" of the sample data; nothing where the data is missing. One clip at 30 keys a
/// second.
std::optional<PoseSequence> load_sample_sequence(const std::string& name);

}  // namespace mdk
