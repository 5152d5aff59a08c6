#include "viewer/panel/pose_panel.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <string>

#include "viewer/panel/ui_parts.h"

namespace mdk {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

int depth_of(const SkeletonView& skeleton, std::uint32_t joint) {
  int depth = 0;
  for (std::uint32_t j = skeleton.joints[joint].parent; j != kNoParent;
       j = skeleton.joints[j].parent)
    ++depth;
  return depth;
}

void draw_joints(const SkeletonView& skeleton, const Theme& theme, HandPose& hand,
                 UiResult& result) {
  const auto count = static_cast<std::uint32_t>(skeleton.joints.size());
  const float rows = std::min(9.0f, static_cast<float>(count));
  ImGui::BeginChild("##joints", {0, rows * ImGui::GetTextLineHeightWithSpacing()});
  for (std::uint32_t j = 0; j < count; ++j) {
    ImGui::PushID(static_cast<int>(j));
    const float indent = static_cast<float>(depth_of(skeleton, j)) * 9 * theme.scale;
    ImGui::SetCursorPosX(ImGui::GetCursorPosX() + indent);
    const bool turned = length(hand.pose.turns[j]) > 0;
    if (!turned) ImGui::PushStyleColor(ImGuiCol_Text, dim_color());
    if (ImGui::Selectable(joint_name(skeleton, j).c_str(), hand.joint == j)) hand.joint = j;
    if (!turned) ImGui::PopStyleColor();
    record(result.widgets, "joint:" + joint_name(skeleton, j));
    ImGui::PopID();
  }
  ImGui::EndChild();
}

void draw_turn(const SkeletonView& skeleton, HandPose& hand, UiResult& result) {
  const double limit = static_cast<double>(skeleton.joints[hand.joint].limit) / kDegree;
  const auto reach = static_cast<float>(hand.beyond_limits ? 180.0 : limit);
  const Vec3d turn = hand.pose.turns[hand.joint] * (1 / kDegree);
  std::array<float, 3> degrees = {static_cast<float>(turn.x), static_cast<float>(turn.y),
                                  static_cast<float>(turn.z)};
  ImGui::TextDisabled("about its own axes, at most %.0f°", limit);
  bool changed = false;
  constexpr std::array<const char*, 3> kAxes = {"x", "y", "z"};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    ImGui::SetNextItemWidth(-ImGui::GetFontSize() * 1.2f);
    changed |= ImGui::SliderFloat(kAxes[axis], &degrees[axis], -reach, reach, "%.1f°",
                                  ImGuiSliderFlags_AlwaysClamp);
    record(result.widgets, std::string("turn:") + kAxes[axis]);
  }
  if (changed)
    turn_joint(hand, skeleton,
               Vec3d{static_cast<double>(degrees[0]), static_cast<double>(degrees[1]),
                     static_cast<double>(degrees[2])} *
                   kDegree);
}

void draw_weights(const Model& model, HandPose& hand, UiResult& result) {
  const std::vector<WeightRange> ranges = weight_ranges(model);
  for (std::size_t t = 0; t < ranges.size(); ++t) {
    const std::string name = "morph " + std::to_string(t);
    ImGui::SetNextItemWidth(-ImGui::GetFontSize() * 5);
    ImGui::SliderFloat(name.c_str(), &hand.pose.target_weights[t], ranges[t].least, ranges[t].most,
                       "%.2f", ImGuiSliderFlags_AlwaysClamp);
    record(result.widgets, name);
  }
}

void draw_limits(const SkeletonView& skeleton, HandPose& hand, UiResult& result) {
  if (ImGui::Checkbox("Beyond limits", &hand.beyond_limits) && !hand.beyond_limits)
    for (std::uint32_t j = 0; j < skeleton.joints.size(); ++j) {
      HandPose back = hand;
      back.joint = j;
      turn_joint(back, skeleton, hand.pose.turns[j]);
      hand.pose.turns[j] = back.pose.turns[j];
    }
  record(result.widgets, "beyond-limits");
  const std::uint32_t past = joint_past_limit(skeleton, hand.pose);
  if (past == kNoParent) return;
  ImGui::PushTextWrapPos(0);
  ImGui::PushStyleColor(ImGuiCol_Text, warning_color());
  ImGui::TextUnformatted((joint_name(skeleton, past) +
                          " is past its limit: the fuzzy boxes do not hold here, the picture is "
                          "traced with boxes of this pose alone (Refitted BVH)")
                             .c_str());
  ImGui::PopStyleColor();
  ImGui::PopTextWrapPos();
  record(result.widgets, "past-limit");
}

}  // namespace

void draw_pose_panel(const Rect& picture, const Theme& theme, ViewState& state, UiResult& result) {
  const Model* model = state.model();
  if (!model || model->skeleton.joints.empty()) return;
  const float margin = 14 * theme.scale;
  ImGui::SetNextWindowPos({picture.x + margin, picture.y + margin}, ImGuiCond_FirstUseEver);
  ImGui::SetNextWindowSize({250 * theme.scale, 0});
  ImGui::PushStyleColor(ImGuiCol_WindowBg, floating_color());
  ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 8 * theme.scale);
  ImGui::Begin("Skeleton", nullptr,
               ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoSavedSettings |
                   ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoFocusOnAppearing);
  HandPose& hand = state.hand;
  ImGui::Checkbox("Pose by hand", &hand.active);
  record(result.widgets, "pose-by-hand");
  if (hand.active) {
    ImGui::SameLine(ImGui::GetWindowContentRegionMax().x - 60 * theme.scale);
    if (ImGui::Button("Rest", {60 * theme.scale, 0})) {
      hand.pose = rest_pose_of(*model).pose;
    }
    record(result.widgets, "pose-rest");
    draw_joints(model->skeleton, theme, hand, result);
    draw_turn(model->skeleton, hand, result);
    draw_weights(*model, hand, result);
    draw_limits(model->skeleton, hand, result);
  } else {
    ImGui::TextDisabled("%zu joints; shown is the clip", model->skeleton.joints.size());
  }
  ImGui::End();
  ImGui::PopStyleVar();
  ImGui::PopStyleColor();
}

}  // namespace mdk
