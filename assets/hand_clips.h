// The gestures of the sample hand.
#pragma once

#include <string>
#include <vector>

#include "assets/hand_skeleton.h"
#include "assets/quaternion.h"

namespace mdk {

/// How far a joint is turned from rest, in degrees: x bends, y twists, z spreads.
using JointAngles = Vec3d;

struct HandClip {
  std::string name;
  std::vector<double> times;                    ///< seconds, one per key, 30 a second
  std::vector<std::vector<JointAngles>> poses;  ///< per key, per joint
};

/// "grasp" (2 s: the open hand closes finger by finger and opens again) and "count" (4 s: from a
/// fist to five fingers and back). Each ends in the pose it began with.
std::vector<HandClip> make_hand_clips(const HandSkeleton& skeleton);

/// The rotation from a joint's rest basis: twist first, then bend, then spread.
Quaternion joint_rotation(const JointAngles& degrees);

}  // namespace mdk
