#include "assets/rig.h"

#include <array>
#include <utility>

namespace mdk {
namespace {

/// From model space into the joint's rest basis, column by column, in metres.
std::array<double, 16> inverse_bind_matrix(const Basis& b, double metres) {
  const Vec3d t = b.vector_to_local(b.origin) * -metres;
  return {b.x.x, b.y.x, b.z.x, 0, b.x.y, b.y.y, b.z.y, 0, b.x.z, b.y.z, b.z.z, 0, t.x, t.y, t.z, 1};
}

Basis parent_basis(const std::vector<RigJoint>& joints, const RigJoint& joint) {
  return joint.parent < 0 ? Basis{} : joints[static_cast<std::size_t>(joint.parent)].rest;
}

Quaternion rest_rotation(const std::vector<RigJoint>& joints, const RigJoint& joint) {
  return rotation_between(parent_basis(joints, joint), joint.rest);
}

}  // namespace

void add_rig(const std::vector<RigJoint>& joints, double metres, GlbScene& scene) {
  GlbSkin skin;
  for (const RigJoint& joint : joints) {
    skin.joints.push_back(static_cast<int>(scene.nodes.size()));
    skin.inverse_bind_matrices.push_back(inverse_bind_matrix(joint.rest, metres));
    GlbNode node;
    node.name = joint.name;
    node.parent = joint.parent;
    node.translation = parent_basis(joints, joint).to_local(joint.rest.origin) * metres;
    node.rotation = rest_rotation(joints, joint);
    scene.nodes.push_back(std::move(node));
  }
  scene.skins.push_back(std::move(skin));
}

void add_rig_clip(const std::vector<RigJoint>& joints, const RigClip& clip, double metres,
                  GlbScene& scene) {
  GlbClip out{clip.name, clip.times, {}};
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const Quaternion rest = rest_rotation(joints, joints[j]);
    GlbTrack track{static_cast<int>(j), GlbPath::kRotation, {}};
    for (const auto& pose : clip.poses) {
      const Quaternion q = rest * joint_rotation(pose[j]);
      track.values.push_back({q.x, q.y, q.z, q.w});
    }
    out.tracks.push_back(std::move(track));
  }
  if (!clip.root_offsets.empty()) {
    GlbTrack track{0, GlbPath::kTranslation, {}};
    for (const Vec3d& offset : clip.root_offsets) {
      const Vec3d t = (joints.front().rest.origin + offset) * metres;
      track.values.push_back({t.x, t.y, t.z});
    }
    out.tracks.push_back(std::move(track));
  }
  scene.clips.push_back(std::move(out));
}

Quaternion joint_rotation(const JointAngles& degrees) {
  return rotation_about(2, degrees.z) * rotation_about(0, degrees.x) * rotation_about(1, degrees.y);
}

}  // namespace mdk
