#include "common/motion/skeleton.h"

#include <cmath>

namespace mdk {

Affine3d rotation(const Vec3d& turn) {
  const double angle = length(turn);
  if (!(angle > 0)) return {};
  const Vec3d u = turn * (1 / angle);
  const double c = std::cos(angle), s = std::sin(angle), t = 1 - c;
  return {{{c + t * u.x * u.x, t * u.x * u.y - s * u.z, t * u.x * u.z + s * u.y, 0},
           {t * u.x * u.y + s * u.z, c + t * u.y * u.y, t * u.y * u.z - s * u.x, 0},
           {t * u.x * u.z - s * u.y, t * u.y * u.z + s * u.x, c + t * u.z * u.z, 0}}};
}

std::vector<Affine3d> world_from_joints(const SkeletonView& skeleton, const SkeletonPose& pose) {
  std::vector<Affine3d> world(skeleton.joints.size());
  for (std::size_t j = 0; j < world.size(); ++j) {
    const Joint& joint = skeleton.joints[j];
    const Affine3d local =
        to_double(joint.parent_from_joint) * rotation(pose.turns[j]) * scaling(joint.scale);
    world[j] = joint.parent == kNoParent ? local : world[joint.parent] * local;
  }
  return world;
}

std::vector<Affine3f> bone_maps(const SkeletonView& skeleton, const SkeletonPose& pose) {
  const std::vector<Affine3d> world = world_from_joints(skeleton, pose);
  std::vector<Affine3f> maps;
  maps.reserve(skeleton.bones.size());
  for (const BoneBinding& bone : skeleton.bones)
    maps.push_back(to_float(world[bone.joint] * to_double(bone.joint_from_base)));
  return maps;
}

std::uint32_t joint_past_limit(const SkeletonView& skeleton, const SkeletonPose& pose) {
  for (std::uint32_t j = 0; j < skeleton.joints.size(); ++j)
    if (!(length(pose.turns[j]) <= skeleton.joints[j].limit)) return j;
  return kNoParent;
}

}  // namespace mdk
