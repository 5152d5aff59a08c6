#include "formats/skeleton_check.h"

#include <cmath>
#include <cstdint>
#include <numbers>

#include "formats/check_text.h"

namespace mdk {
namespace {

std::string check_sizes(const Model& m) {
  const SkeletonView& s = m.skeleton;
  if (s.joints.empty()) {
    for (const std::string& fault : {count_fault("joint_names", s.names.size(), 0),
                                     count_fault("bone_bindings", s.bones.size(), 0),
                                     count_fault("cluster_bones", m.cluster_bones.size(), 0)}) {
      if (!fault.empty()) return fault;
    }
    return {};
  }
  if (m.poses.kind != PoseKind::kRig) return "joints: there, though poses do not come from a rig";
  if (m.segments.size() != 1) return "segments: more than one, though the skeleton needs one";
  const std::uint64_t bones = m.poses.rig.bone_maps.size() / m.key_count();
  const std::string fault = count_fault("bone_bindings", s.bones.size(), bones);
  return fault.empty() ? count_fault("cluster_bones", m.cluster_bones.size(), m.clusters.size())
                       : fault;
}

std::string check_joints(const SkeletonView& s) {
  std::uint64_t next_name = 0;
  for (std::size_t j = 0; j < s.joints.size(); ++j) {
    const Joint& joint = s.joints[j];
    const std::string name = "joints: joint " + number(j);
    if (joint.parent != kNoParent && joint.parent >= j)
      return name + " does not stand after its parent";
    if (!(joint.limit >= 0 && joint.limit <= std::numbers::pi_v<float>))
      return name + " has a limit that is no angle from 0 to pi";
    if (joint.name_offset != next_name || joint.name_bytes > s.names.size() - next_name)
      return name + " has no name in joint_names";
    next_name += joint.name_bytes;
    if (!is_finite(joint.parent_from_joint) || !std::isfinite(joint.scale.x) ||
        !std::isfinite(joint.scale.y) || !std::isfinite(joint.scale.z))
      return name + " has a rest transform that is not finite";
  }
  if (next_name != s.names.size()) return "joint_names: some belong to no joint";
  return {};
}

}  // namespace

std::string check_skeleton(const Model& m) {
  if (const std::string fault = check_sizes(m); !fault.empty()) return fault;
  const SkeletonView& s = m.skeleton;
  if (const std::string fault = check_joints(s); !fault.empty()) return fault;
  for (std::size_t i = 0; i < s.bones.size(); ++i) {
    const std::string name = "bone_bindings: bone " + number(i);
    if (s.bones[i].joint >= s.joints.size()) return name + " hangs on a joint there is not";
    if (!is_finite(s.bones[i].joint_from_base)) return name + " has a map that is not finite";
  }
  for (std::size_t c = 0; c < m.cluster_bones.size(); ++c) {
    const std::string name = "cluster_bones: cluster " + number(c);
    if (m.cluster_bones[c].bone >= s.bones.size()) return name + " follows a bone there is not";
    if (!is_finite(m.cluster_bones[c].local_from_base))
      return name + " has a map that is not finite";
  }
  return {};
}

}  // namespace mdk
