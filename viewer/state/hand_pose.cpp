#include "viewer/state/hand_pose.h"

#include <algorithm>

namespace mdk {

HandPose rest_pose_of(const Model& model) {
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

std::vector<WeightRange> weight_ranges(const Model& model) {
  const auto& weights = model.poses.rig.target_weights;
  const std::size_t targets = weights.size() / model.key_count();
  std::vector<WeightRange> ranges;
  for (std::size_t t = 0; t < targets; ++t) {
    WeightRange range{weights[t], weights[t]};
    for (std::size_t i = t; i < weights.size(); i += targets) {
      range.least = std::min(range.least, weights[i]);
      range.most = std::max(range.most, weights[i]);
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
