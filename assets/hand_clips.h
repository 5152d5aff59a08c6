// The gestures of the sample hand.
#pragma once

#include <vector>

#include "assets/hand_skeleton.h"
#include "assets/rig.h"

namespace mdk {

/// "grasp" (2 s: the open hand closes finger by finger and opens again) and "count" (4 s: from a
/// fist to five fingers and back), each ending in the pose it began with, and "beckon" (30 keys).
std::vector<RigClip> make_hand_clips(const HandSkeleton& skeleton);

}  // namespace mdk
