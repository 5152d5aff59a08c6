// The bones of BEN, a runner, and his run.
#pragma once

#include <array>
#include <vector>

#include "assets/rig.h"

namespace mdk {

/// Joints of one side of the body, as numbers of joints; side 0 is his right (+z), 1 his left.
struct BenLimbs {
  int upper_arm = 0, forearm = 0, hand = 0, thigh = 0, shin = 0, foot = 0, toes = 0;
};

/// Metres; he looks to +x and stands on y = 0, arms held away from the body. Every joint bends
/// forwards about its x.
struct BenRig {
  std::vector<RigJoint> joints;  ///< parents first; joint 0 is the root
  int hips = 0, spine = 0, chest = 0, neck = 0, head = 0;
  std::array<BenLimbs, 2> sides;

  const Basis& rest(int joint) const { return joints[static_cast<std::size_t>(joint)].rest; }
  /// A point along the bone of the joint; 0 is the joint, 1 its end.
  Vec3d on_bone(int joint, double along) const {
    return rest(joint).to_world({0, joints[static_cast<std::size_t>(joint)].length * along, 0});
  }
};

BenRig make_ben_rig();

/// "run": 30 keys, 30 a second, two strides on the spot; the key after the last is the first.
RigClip make_ben_run(const BenRig& rig);

}  // namespace mdk
