// Skeleton: the joints behind a rig's bones, so that a mesh can be posed by hand, also in poses
// that no clip contains (GFSS06; Lo09 §4.3). A joint turns about its own origin:
//
//     world_from_joint = world_from_parent * parent_from_joint * turn * scale
//     bone (world from base) = world_from_joint * joint_from_base
//
// Translations and scales stay as they are at rest. A limit says how far a joint may turn from its
// rest rotation, about any axis: the poses within all limits are what boxes can be made for.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/math/affine3.h"

namespace mdk {

inline constexpr std::uint32_t kNoParent = 0xffffffffu;

/// 80 bytes, as the file holds it.
struct Joint {
  std::uint32_t parent = kNoParent;  ///< a lower number than its own
  float limit = 0;                   ///< radians, in [0, pi]
  std::uint32_t name_offset = 0, name_bytes = 0;
  Affine3f parent_from_joint;  ///< at rest, without its scale
  Vec3f scale{1, 1, 1};
  std::uint32_t reserved = 0;
};
static_assert(sizeof(Joint) == 80);

/// Which joint a bone of the rig hangs on. 52 bytes, as the file holds it.
struct BoneBinding {
  std::uint32_t joint = 0;
  Affine3f joint_from_base;
};
static_assert(sizeof(BoneBinding) == 52);

struct SkeletonView {
  std::span<const Joint> joints;
  std::span<const char> names;         ///< one after another
  std::span<const BoneBinding> bones;  ///< one per bone of the rig

  std::string_view name(const Joint& joint) const {
    return {names.data() + joint.name_offset, joint.name_bytes};
  }
};

struct Skeleton {
  std::vector<Joint> joints;
  std::vector<char> names;
  std::vector<BoneBinding> bones;

  /// Valid while this lives and is not changed.
  SkeletonView view() const { return {joints, names, bones}; }
};

/// How a skeleton stands, apart from its rest.
struct SkeletonPose {
  std::vector<Vec3d> turns;           ///< per joint, in its own axes: axis times angle in radians
  std::vector<float> target_weights;  ///< per morph target of the rig

  bool operator==(const SkeletonPose&) const = default;
};

/// The rotation by |turn| radians about `turn`.
Affine3d rotation(const Vec3d& turn);

/// x -> s x, coordinate by coordinate.
inline Affine3d scaling(const Vec3f& s) {
  Affine3d a;
  a.m[0][0] = s.x;
  a.m[1][1] = s.y;
  a.m[2][2] = s.z;
  return a;
}

/// Per joint. `pose` has a turn for each. Cost: O(joints).
std::vector<Affine3d> world_from_joints(const SkeletonView& skeleton, const SkeletonPose& pose);

/// Per bone: world from base, rounded to float once.
std::vector<Affine3f> bone_maps(const SkeletonView& skeleton, const SkeletonPose& pose);

/// The first joint that is turned past its limit (or by no number at all); kNoParent where none is.
std::uint32_t joint_past_limit(const SkeletonView& skeleton, const SkeletonPose& pose);

}  // namespace mdk
