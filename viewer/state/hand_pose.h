// HandPose: a skeleton posed by hand instead of by a clip, and whether the boxes still hold there.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "common/motion/model.h"
#include "common/motion/skeleton.h"

namespace mdk {

struct HandPose {
  bool active = false;         ///< it is what is shown
  bool beyond_limits = false;  ///< joints may be turned past what the boxes were made for
  std::uint32_t joint = 0;     ///< the chosen one
  SkeletonPose pose;
};

/// At rest, with the morph weights of the first key, the first joint chosen that can turn.
/// Inactive.
HandPose rest_pose_of(const Model& model);

/// Range of each morph weight over the clips, which the boxes hold for.
struct WeightRange {
  float least = 0, most = 0;
};
std::vector<WeightRange> weight_ranges(const Model& model);

/// Turns the chosen joint by the rotation vector `turn` (radians, in its own axes), shortened to
/// its limit unless it may go beyond.
void turn_joint(HandPose& hand, const SkeletonView& skeleton, const Vec3d& turn);

/// The name of a joint, or "joint 7" where it has none.
std::string joint_name(const SkeletonView& skeleton, std::uint32_t joint);

}  // namespace mdk
