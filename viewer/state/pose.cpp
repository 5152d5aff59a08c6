#include "viewer/state/pose.h"

#include <algorithm>

#include "common/math/affine3.h"

namespace mdk {

PosedMesh mesh_at(const ModelView& model, const Moment& moment) {
  PosedMesh mesh(model);
  if (moment.pose)
    mesh.set_pose(*moment.pose);
  else
    mesh.set_time(moment.at);
  return mesh;
}

ClusterPlaces cluster_places(const ModelView& model, const Moment& moment) {
  ClusterPlaces places;
  const std::uint32_t clusters = model.cluster_count();
  if (moment.pose) {
    const PosedMesh mesh = mesh_at(model, moment);
    for (std::uint32_t c = 0; c < clusters; ++c) {
      places.local_from_world.push_back(mesh.cluster_map(c));
      places.world_boxes.push_back(mesh.cluster_box(c));
    }
    return places;
  }
  const KeyInterval& at = moment.at;
  for (std::uint32_t c = 0; c < clusters; ++c) {
    places.local_from_world.push_back(
        interpolate(model.key_maps(at.key0)[c], model.key_maps(at.key1)[c], at.s));
    places.world_boxes.push_back(cluster_world_box(model, c, at));
  }
  return places;
}

std::array<Vec3d, 3> corners_at(const ModelView& model, const Moment& moment,
                                std::uint32_t triangle) {
  const Triangle& corners = model.triangles[triangle];
  std::array<Vec3d, 3> places;
  if (moment.pose) {
    const PosedMesh mesh = mesh_at(model, moment);
    for (std::size_t i = 0; i < 3; ++i) places[i] = to_double(mesh.positions()[corners.v[i]]);
    return places;
  }
  const KeyInterval& at = moment.at;
  for (std::size_t i = 0; i < 3; ++i) {
    const VertexRange corner{corners.v[i], corners.v[i] + 1};
    Vec3f from, to;
    decode_pose(model, at.key0, corner, {&from, 1});
    decode_pose(model, at.key1, corner, {&to, 1});
    places[i] = to_double(at.key0 == at.key1 ? from : from + (to - from) * at.s);
  }
  return places;
}

std::uint32_t segment_of(const ModelView& model, const Moment& moment) {
  return moment.pose ? 0 : segment_of(model, moment.at);
}

HandPose rest_pose_of(const ModelView& model) {
  HandPose hand;
  const auto& joints = model.skeleton.joints;
  if (joints.empty()) return hand;
  hand.pose.turns.resize(joints.size());
  const auto& weights = model.poses.rig.target_weights;
  const auto targets = static_cast<std::ptrdiff_t>(weights.size() / model.key_count());
  hand.pose.target_weights.assign(weights.begin(), weights.begin() + targets);
  while (hand.joint + 1 < joints.size() && !(joints[hand.joint].limit > 0)) ++hand.joint;
  return hand;
}

std::vector<WeightRange> weight_ranges(const ModelView& model) {
  const auto& weights = model.poses.rig.target_weights;
  const std::size_t targets = weights.size() / model.key_count();
  std::vector<WeightRange> ranges;
  for (std::size_t t = 0; t < targets; ++t) {
    WeightRange range{weights[t], weights[t]};
    for (std::size_t i = t; i < weights.size(); i += targets) {
      range.min = std::min(range.min, weights[i]);
      range.max = std::max(range.max, weights[i]);
    }
    ranges.push_back(range);
  }
  return ranges;
}

void turn_joint(HandPose& hand, const SkeletonView& skeleton, const Vec3d& turn) {
  const double limit = static_cast<double>(skeleton.joints[hand.joint].limit);
  const double angle = length(turn);
  const bool shortened = !hand.beyond_limits && angle > limit;
  // A little less than the limit, which rounding must not pass.
  hand.pose.turns[hand.joint] = shortened ? turn * (limit * (1 - 1e-9) / angle) : turn;
}

std::string joint_name(const SkeletonView& skeleton, std::uint32_t joint) {
  const std::string name(skeleton.name(skeleton.joints[joint]));
  return name.empty() ? "joint " + std::to_string(joint) : name;
}

}  // namespace mdk
