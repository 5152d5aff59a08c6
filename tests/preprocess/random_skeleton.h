// A branching skeleton with a skinned, morphing cloud of triangles on it, from a seed.
#pragma once

#include <cstdint>
#include <random>

#include "common/motion/pose_sequence.h"
#include "common/motion/rig.h"

namespace mdk {

struct SkinnedMesh {
  PoseSequence sequence;  ///< with a rig; keys are poses within the limits
  Skeleton skeleton;
  std::vector<SkeletonPose> key_poses;
};

/// Every joint's limit is `limit` radians; scales differ from 1, and from axis to axis, here and
/// there.
SkinnedMesh random_skinned_mesh(std::uint32_t seed, std::uint32_t keys, double limit);

/// Every joint turned by up to `share` of its limit, half of them by all of it; morph weights
/// between those of two keys.
SkeletonPose random_pose(const SkinnedMesh& mesh, double share, std::mt19937& random);

}  // namespace mdk
