#include "formats/gltf/pose.h"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "common/base/error.h"

namespace mdk::gltf {
namespace {

struct NodeState {
  Vec3d translation;
  Quaternion rotation;
  Vec3d scale;
};

/// Static transforms with the clip's tracks laid over them.
std::vector<NodeState> local_states(const Document& document, const AnimationClip& clip,
                                    double time, NodePose& pose) {
  std::vector<NodeState> states;
  states.reserve(document.nodes.size());
  for (const Node& node : document.nodes) {
    states.push_back({node.translation, node.rotation, node.scale});
    pose.weights.push_back(node.weights);
  }
  std::array<double, 4> value{};
  for (const Track& track : clip.tracks) {
    const auto n = static_cast<std::size_t>(track.node);
    if (track.path == TrackPath::kWeights) {
      sample(track, time, pose.weights[n]);
      continue;
    }
    sample(track, time, std::span(value).first(track.components));
    if (track.path == TrackPath::kTranslation)
      states[n].translation = {value[0], value[1], value[2]};
    else if (track.path == TrackPath::kScale)
      states[n].scale = {value[0], value[1], value[2]};
    else
      states[n].rotation = {value[0], value[1], value[2], value[3]};
  }
  return states;
}

}  // namespace

std::span<const Influence> Instance::influences(std::size_t vertex) const {
  if (skin == kNone) return {};
  const std::vector<std::uint32_t>& first = geometry->first_influence;
  return std::span(geometry->influences).subspan(first[vertex], first[vertex + 1] - first[vertex]);
}

std::vector<SkinBinding> read_skins(const Document& document) {
  std::vector<SkinBinding> skins;
  for (const Skin& skin : document.skins) {
    SkinBinding binding{skin.joints, std::vector<Affine3d>(skin.joints.size())};
    if (skin.inverse_bind_matrices != kNone) {
      const std::vector<float> columns = read_floats(document, skin.inverse_bind_matrices);
      for (std::size_t j = 0; j < skin.joints.size(); ++j)
        for (std::size_t c = 0; c < 4; ++c)
          for (std::size_t r = 0; r < 3; ++r)
            binding.joint_from_vertex[j].m[r][c] = columns[16 * j + 4 * c + r];
    }
    skins.push_back(std::move(binding));
  }
  return skins;
}

NodePose pose_nodes(const Document& document, const AnimationClip& clip, double seconds) {
  NodePose pose;
  pose.weights.reserve(document.nodes.size());
  const std::vector<NodeState> states = local_states(document, clip, clip.start + seconds, pose);
  pose.world_from_node.resize(document.nodes.size());
  for (int number : document.node_order) {
    const auto n = static_cast<std::size_t>(number);
    const Node& node = document.nodes[n];
    const NodeState& s = states[n];
    const Affine3d local =
        node.has_matrix ? node.matrix : compose(s.translation, s.rotation, s.scale);
    pose.world_from_node[n] =
        node.parent == kNone ? local : entry(pose.world_from_node, node.parent) * local;
  }
  return pose;
}

std::vector<Affine3d> pose_joints(const SkinBinding& skin, const NodePose& pose) {
  std::vector<Affine3d> maps;
  maps.reserve(skin.joints.size());
  for (std::size_t j = 0; j < skin.joints.size(); ++j)
    maps.push_back(entry(pose.world_from_node, skin.joints[j]) * skin.joint_from_vertex[j]);
  return maps;
}

bool is_mirrored(const Instance& instance, const NodePose& pose, std::span<const Affine3d> joints) {
  const auto sign = [](double x) { return x > 0 ? 1.0 : x < 0 ? -1.0 : 0.0; };
  const double node_sign = sign(entry(pose.world_from_node, instance.node).determinant());
  if (instance.skin == kNone) return node_sign < 0;
  std::vector<double> joint_signs;
  for (const Affine3d& map : joints) joint_signs.push_back(sign(map.determinant()));
  double sum = 0;
  for (std::size_t i = 0; i < instance.geometry->positions.size(); ++i) {
    const std::span<const Influence> influences = instance.influences(i);
    if (influences.empty()) sum += node_sign;
    for (const Influence& influence : influences)
      sum += influence.weight * joint_signs[influence.joint];
  }
  return sum < 0;
}

RigPlan::RigPlan(std::span<const Instance> instances, std::span<const SkinBinding> skins)
    : instances_(instances), skins_(skins) {
  const auto next_bone = [&] { return static_cast<std::uint32_t>(bone_count_); };
  for (const Instance& instance : instances_) {
    // A vertex that no joint moves goes with its node, like a mesh without skin.
    if (node_bones_.try_emplace(instance.node, next_bone()).second) ++bone_count_;
    if (instance.skin != kNone && skin_bones_.try_emplace(instance.skin, next_bone()).second)
      bone_count_ += entry(skins_, instance.skin).joints.size();
    const PrimitiveGeometry& geometry = *instance.geometry;
    const std::size_t targets = geometry.target_offsets.size();
    max_links_ += std::max(geometry.influences.size(), targets * geometry.positions.size()) +
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
    const std::span<const Influence> influences = instance.influences(i);
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
    for (; node != kNone && !entry(is_joint, node); node = entry(document.nodes, node).parent)
      entry(is_joint, node) = 1;
  };
  for (const auto& [node, bone] : node_bones_) mark(node);
  for (const auto& [skin, first] : skin_bones_)
    for (const int node : entry(skins_, skin).joints) mark(node);
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
    if (node.parent != kNone) joint.parent = entry(joint_of, node.parent);
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
  for (const auto& [node, bone] : node_bones_) skeleton.bones[bone].joint = entry(joint_of, node);
  for (const auto& [skin, first] : skin_bones_) {
    const SkinBinding& binding = entry(skins_, skin);
    for (std::size_t j = 0; j < binding.joints.size(); ++j)
      skeleton.bones[first + j] = {entry(joint_of, binding.joints[j]),
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
    bones[bone] = to_float(entry(pose.world_from_node, node));
  for (const auto& [skin, first] : skin_bones_) {
    std::uint32_t bone = first;
    for (const Affine3d& map : pose_joints(entry(skins_, skin), pose))
      bones[bone++] = to_float(map);
  }
  for (std::size_t t = 0; t < targets_.size(); ++t) {
    const Target& target = targets_[t];
    rig.target_weights[key * targets_.size() + t] =
        static_cast<float>(entry(pose.weights, target.node)[target.number]);
  }
}

}  // namespace mdk::gltf
