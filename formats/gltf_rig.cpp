#include "formats/gltf_rig.h"

#include <algorithm>

#include "common/math/affine3.h"

namespace mdk::gltf {
namespace {

std::span<const Influence> influences_of(const Instance& instance, std::size_t vertex) {
  if (instance.skin == kNone) return {};
  const PrimitiveGeometry& g = *instance.geometry;
  return std::span(g.influences)
      .subspan(g.first_influence[vertex],
               g.first_influence[vertex + 1] - g.first_influence[vertex]);
}

}  // namespace

RigPlan::RigPlan(std::span<const Instance> instances, std::span<const SkinBinding> skins)
    : instances_(instances), skins_(skins) {
  const auto next_bone = [&] { return static_cast<std::uint32_t>(bone_count_); };
  for (const Instance& instance : instances_) {
    // A vertex that no joint moves goes with its node, like a mesh without skin.
    if (node_bones_.try_emplace(instance.node, next_bone()).second) ++bone_count_;
    if (instance.skin != kNone && skin_bones_.try_emplace(instance.skin, next_bone()).second)
      bone_count_ += skins_[static_cast<std::size_t>(instance.skin)].joints.size();
    const PrimitiveGeometry& geometry = *instance.geometry;
    const std::size_t targets = geometry.target_offsets.size();
    most_links_ += std::max(geometry.influences.size(), targets * geometry.positions.size()) +
                   geometry.positions.size();
    const auto first = static_cast<std::uint32_t>(targets_.size());
    if (targets == 0 || !node_targets_.try_emplace(instance.node, first).second) continue;
    for (std::size_t t = 0; t < targets; ++t) targets_.push_back({instance.node, t});
  }
}

void RigPlan::append_vertices(const Instance& instance, Rig& rig) const {
  const PrimitiveGeometry& geometry = *instance.geometry;
  const std::uint32_t node_bone = node_bones_.at(instance.node);
  for (std::size_t i = 0; i < geometry.positions.size(); ++i) {
    rig.base_positions.push_back(geometry.positions[i]);
    const std::span<const Influence> influences = influences_of(instance, i);
    if (influences.empty()) rig.bone_weights.push_back({node_bone, 1.0f});
    for (const Influence& influence : influences)
      rig.bone_weights.push_back(
          {skin_bones_.at(instance.skin) + influence.joint, static_cast<float>(influence.weight)});
    rig.first_weight.push_back(static_cast<std::uint32_t>(rig.bone_weights.size()));
    for (std::size_t t = 0; t < geometry.target_offsets.size(); ++t) {
      const std::vector<Vec3f>& offsets = geometry.target_offsets[t];
      if (offsets.empty() || offsets[i] == Vec3f{}) continue;
      const auto number = static_cast<std::uint32_t>(t);
      rig.morph_offsets.push_back({node_targets_.at(instance.node) + number, offsets[i]});
    }
    if (!targets_.empty())
      rig.first_offset.push_back(static_cast<std::uint32_t>(rig.morph_offsets.size()));
  }
}

Rig RigPlan::shape() const {
  Rig rig;
  rig.first_weight = {0};
  if (!targets_.empty()) rig.first_offset = {0};
  for (const Instance& instance : instances_) append_vertices(instance, rig);
  return rig;
}

std::vector<char> RigPlan::joint_nodes(const Document& document) const {
  std::vector<char> is_joint(document.nodes.size(), 0);
  const auto mark = [&](int node) {
    for (; node != kNone && !is_joint[static_cast<std::size_t>(node)];
         node = document.nodes[static_cast<std::size_t>(node)].parent)
      is_joint[static_cast<std::size_t>(node)] = 1;
  };
  for (const auto& [node, bone] : node_bones_) mark(node);
  for (const auto& [skin, first] : skin_bones_)
    for (const int node : skins_[static_cast<std::size_t>(skin)].joints) mark(node);
  return is_joint;
}

Skeleton RigPlan::skeleton(const Document& document) const {
  const std::vector<char> is_joint = joint_nodes(document);
  std::vector<std::uint32_t> joint_of(document.nodes.size(), kNoParent);
  Skeleton skeleton;
  for (const int number : document.node_order) {
    const auto n = static_cast<std::size_t>(number);
    if (!is_joint[n]) continue;
    const Node& node = document.nodes[n];
    Joint joint;
    if (node.parent != kNone) joint.parent = joint_of[static_cast<std::size_t>(node.parent)];
    joint.name_offset = static_cast<std::uint32_t>(skeleton.names.size());
    joint.name_bytes = static_cast<std::uint32_t>(node.name.size());
    skeleton.names.insert(skeleton.names.end(), node.name.begin(), node.name.end());
    joint.parent_from_joint = to_float(
        node.has_matrix ? node.matrix : compose(node.translation, node.rotation, {1, 1, 1}));
    if (!node.has_matrix) joint.scale = to_float(node.scale);
    joint_of[n] = static_cast<std::uint32_t>(skeleton.joints.size());
    skeleton.joints.push_back(joint);
  }
  skeleton.bones.resize(bone_count_);
  for (const auto& [node, bone] : node_bones_)
    skeleton.bones[bone].joint = joint_of[static_cast<std::size_t>(node)];
  for (const auto& [skin, first] : skin_bones_) {
    const SkinBinding& binding = skins_[static_cast<std::size_t>(skin)];
    for (std::size_t j = 0; j < binding.joints.size(); ++j)
      skeleton.bones[first + j] = {joint_of[static_cast<std::size_t>(binding.joints[j])],
                                   to_float(binding.joint_from_vertex[j])};
  }
  return skeleton;
}

void RigPlan::make_room(Rig& rig, std::size_t key_count) const {
  rig.bone_maps.resize(key_count * bone_count_);
  rig.target_weights.resize(key_count * targets_.size());
}

void RigPlan::set_key(Rig& rig, std::size_t key, const NodePose& pose) const {
  Affine3f* bones = &rig.bone_maps[key * bone_count_];
  for (const auto& [node, bone] : node_bones_)
    bones[bone] = to_float(pose.world_from_node[static_cast<std::size_t>(node)]);
  for (const auto& [skin, first] : skin_bones_) {
    std::uint32_t bone = first;
    for (const Affine3d& map : pose_joints(skins_[static_cast<std::size_t>(skin)], pose))
      bones[bone++] = to_float(map);
  }
  for (std::size_t t = 0; t < targets_.size(); ++t) {
    const Target& target = targets_[t];
    rig.target_weights[key * targets_.size() + t] =
        static_cast<float>(pose.weights[static_cast<std::size_t>(target.node)][target.number]);
  }
}

}  // namespace mdk::gltf
