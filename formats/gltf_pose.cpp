#include "formats/gltf_pose.h"

#include <array>
#include <string>
#include <utility>

#include "common/base/error.h"
#include "formats/gltf_accessor.h"

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

std::span<const Influence> influences_of(const PrimitiveGeometry& geometry, std::size_t i) {
  return std::span(geometry.influences)
      .subspan(geometry.first_influence[i],
               geometry.first_influence[i + 1] - geometry.first_influence[i]);
}

}  // namespace

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
        node.parent == kNone ? local
                             : pose.world_from_node[static_cast<std::size_t>(node.parent)] * local;
  }
  return pose;
}

std::vector<Affine3d> pose_joints(const SkinBinding& skin, const NodePose& pose) {
  std::vector<Affine3d> maps;
  maps.reserve(skin.joints.size());
  for (std::size_t j = 0; j < skin.joints.size(); ++j)
    maps.push_back(pose.world_from_node[static_cast<std::size_t>(skin.joints[j])] *
                   skin.joint_from_vertex[j]);
  return maps;
}

bool is_mirrored(const Instance& instance, const NodePose& pose, std::span<const Affine3d> joints) {
  const auto sign = [](double x) { return x > 0 ? 1.0 : x < 0 ? -1.0 : 0.0; };
  const double node_sign =
      sign(pose.world_from_node[static_cast<std::size_t>(instance.node)].determinant());
  if (instance.skin == kNone) return node_sign < 0;
  std::vector<double> joint_signs;
  for (const Affine3d& map : joints) joint_signs.push_back(sign(map.determinant()));
  double sum = 0;
  for (std::size_t i = 0; i < instance.geometry->positions.size(); ++i) {
    const std::span<const Influence> influences = influences_of(*instance.geometry, i);
    if (influences.empty()) sum += node_sign;
    for (const Influence& influence : influences)
      sum += influence.weight * joint_signs[influence.joint];
  }
  return sum < 0;
}

}  // namespace mdk::gltf
