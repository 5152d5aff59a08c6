// What may lie over the picture in boxes: welcome, bake, error, notice, file menu, keys, skeleton.
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <array>
#include <numbers>
#include <string>

#include "formats/files/file_kind.h"
#include "viewer/panel/panel.h"
#include "viewer/panel/widgets.h"

namespace mdk {
namespace {

constexpr ImGuiWindowFlags kFloating =
    kFixedBox | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoFocusOnAppearing;
const ImVec2 kWidePadding{20, 16};
constexpr double kDegree = std::numbers::pi / 180;

constexpr float kHelpWidth = 580;  // on an ordinary display

/// Each line in the middle of the window, and no wider than it.
void centered_text(const std::string& text, ImFont* font, ImU32 color) {
  ImGui::PushFont(font);
  ImGui::PushStyleColor(ImGuiCol_Text, color);
  const float room = ImGui::GetContentRegionAvail().x;
  const float scale = ImGui::GetFontSize() / font->FontSize;
  const char *at = text.c_str(), *const end = at + text.size();
  while (at < end) {
    const char* const stop =
        std::max(at + 1, font->CalcWordWrapPositionA(scale, at, end, std::max(room, 1.0f)));
    const float width = ImGui::CalcTextSize(at, stop).x;
    ImGui::SetCursorPosX((ImGui::GetWindowSize().x - width) / 2);
    ImGui::TextUnformatted(at, stop);
    at = stop;
    while (at < end && *at == ' ') ++at;
  }
  ImGui::PopStyleColor();
  ImGui::PopFont();
}

void draw_welcome(const Rect& picture, const Theme& theme) {
  center_next_window(picture);
  ImGui::SetNextWindowSize({std::min(picture.width, 560 * theme.scale), 0});
  ImGui::SetNextWindowBgAlpha(0);
  ImGui::Begin("##welcome", nullptr, kFloating | ImGuiWindowFlags_NoInputs);
  centered_text("Drop an animation here", theme.fonts.large, text_color());
  ImGui::Spacing();
  centered_text(".mdk opens at once", theme.fonts.text, dim_color());
  centered_text(has_assimp()
                    ? ".glb, .gltf, .fbx, .dae and more, or an .obj with its .pc2 or .mdd, "
                      "are baked first"
                    : ".glb, .gltf, or an .obj with its .pc2 or .mdd, are baked first",
                theme.fonts.text, dim_color());
  ImGui::Spacing();
  centered_text("To keep what is baked", theme.fonts.text, dim_color());
  centered_text("mdprep bake hand.glb -o hand.mdk", theme.fonts.text, text_color());
  ImGui::Spacing();
  centered_text("Press L for recent files, ? for the keys", theme.fonts.text, dim_color());
  ImGui::End();
}

void draw_baking(const Rect& picture, const Theme& theme, const SceneLoader::Progress& baking,
                 UiResult& result) {
  center_next_window(picture);
  ImGui::SetNextWindowSize({std::min(picture.width, 380 * theme.scale), 0});
  const FloatingBox box("##baking", theme, kFloating, kWidePadding);
  ImGui::PushFont(theme.fonts.strong);
  ImGui::TextUnformatted(("Baking " + baking.name).c_str());
  ImGui::PopFont();
  ImGui::ProgressBar(static_cast<float>(baking.bake.fraction), {-1, 6 * theme.scale}, "");
  ImGui::AlignTextToFramePadding();
  const auto words = std::min(baking.bake.text.find_first_not_of(' '), baking.bake.text.size());
  ImGui::TextDisabled("%s", baking.bake.text.empty() ? "starting" : &baking.bake.text[words]);
  record(result.widgets, "bake-progress");
  const float button = 80 * theme.scale;
  ImGui::SameLine(ImGui::GetWindowContentRegionMax().x - button);
  if (ImGui::Button("Cancel", {button, 0})) result.actions.push_back({Command::kCancelBake});
  record(result.widgets, "cancel-bake");
}

void draw_error(const Rect& picture, const Theme& theme, ViewState& state, UiResult& result) {
  const float margin = 14 * theme.scale;
  ImGui::SetNextWindowPos({picture.x + margin, picture.y + margin});
  ImGui::SetNextWindowSize({std::max(80.0f, picture.width - 2 * margin), 0});
  const FloatingBox box("##error", theme, kFloating, {}, error_color());
  const float button = ImGui::GetFrameHeight();
  const float button_x = ImGui::GetWindowContentRegionMax().x - button;
  ImGui::PushTextWrapPos(button_x - margin);
  ImGui::AlignTextToFramePadding();
  ImGui::TextUnformatted(state.error.c_str());
  ImGui::PopTextWrapPos();
  record(result.widgets, "error");
  ImGui::SameLine(button_x);
  if (ImGui::Button("x", {button, 0})) state.error.clear();
  record(result.widgets, "dismiss-error");
}

void draw_notice(const Rect& picture, const Theme& theme, const std::string& notice) {
  const float margin = 14 * theme.scale;
  ImGui::SetNextWindowPos({picture.x + margin, picture.y + picture.height - margin},
                          ImGuiCond_Always, {0, 1});
  const FloatingBox box("##notice", theme, kFloating | ImGuiWindowFlags_NoInputs);
  ImGui::TextUnformatted(notice.c_str());
}

// In the middle of the picture where that is wide enough, else of the window; it scrolls where the
// window is too small for all.
void draw_help(const Rect& picture, const Theme& theme, UiResult& result) {
  const ImVec2 window = ImGui::GetIO().DisplaySize;
  const bool fits = picture.width >= kHelpWidth * theme.scale;
  ImGui::SetNextWindowPos({fits ? picture.x + picture.width / 2 : window.x / 2, window.y / 2},
                          ImGuiCond_Always, {0.5f, 0.5f});
  ImGui::SetNextWindowSizeConstraints({0, 0}, {std::max(1.0f, window.x), std::max(1.0f, window.y)});
  const FloatingBox box("##help", theme, kFloating, {24, 18});
  ImGui::PushFont(theme.fonts.strong);
  ImGui::TextUnformatted("Keys and mouse");
  ImGui::PopFont();
  ImGui::Spacing();
  if (ImGui::BeginTable("##keys", 2, ImGuiTableFlags_SizingFixedFit)) {
    for (const Shortcut& line : shortcuts()) {
      ImGui::TableNextColumn();
      ImGui::TextUnformatted(line.keys);
      ImGui::SameLine(0, 26 * theme.scale);
      ImGui::TableNextColumn();
      ImGui::TextDisabled("%s", line.does);
    }
    ImGui::EndTable();
  }
  const ImVec2 corner = ImGui::GetWindowPos(), size = ImGui::GetWindowSize();
  result.widgets["help-overlay"] = {corner.x, corner.y, size.x, size.y};
}

void draw_choices(const Theme& theme, const FileMenu& menu, UiResult& result) {
  const float line = ImGui::GetTextLineHeightWithSpacing() * 2;
  const float rows = std::min(6.0f, static_cast<float>(menu.choices.size()));
  ImGui::BeginChild("##choices", {0, rows * line});
  for (std::size_t i = 0; i < menu.choices.size(); ++i) {
    const FileChoice& choice = menu.choices[i];
    ImGui::PushID(static_cast<int>(i));
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    if (ImGui::Selectable("##choice", false, 0, {0, line - ImGui::GetStyle().ItemSpacing.y}))
      result.open_paths = choice.paths;
    ImGui::PopID();
    record(result.widgets, "choice:" + std::to_string(i));
    ImDrawList& draw = *ImGui::GetWindowDrawList();
    draw.AddText({corner.x + 4 * theme.scale, corner.y}, text_color(), choice.label.c_str());
    draw.AddText({corner.x + 4 * theme.scale, corner.y + ImGui::GetTextLineHeight()}, dim_color(),
                 choice.paths.front().c_str());
  }
  ImGui::EndChild();
}

void draw_file_menu(const Rect& picture, const Theme& theme, ViewState& state, UiResult& result) {
  FileMenu& menu = *state.file_menu;
  center_next_window(picture);
  ImGui::SetNextWindowSize({std::min(picture.width, 560 * theme.scale), 0});
  const FloatingBox box("##file-menu", theme, kFixedBox, kWidePadding);
  ImGui::PushFont(theme.fonts.strong);
  ImGui::TextUnformatted(menu.title.c_str());
  ImGui::PopFont();
  record(result.widgets, "file-menu");
  if (menu.choices.empty())
    ImGui::TextDisabled("None yet. Drop an animation or a folder of them on the window, or type:");
  else
    draw_choices(theme, menu, result);
  const float button = 80 * theme.scale;
  ImGui::SetNextItemWidth(-2 * (button + ImGui::GetStyle().ItemSpacing.x));
  if (ImGui::IsWindowAppearing()) ImGui::SetKeyboardFocusHere();
  bool typed = ImGui::InputTextWithHint("##path", "path of a file or folder", &menu.typed,
                                        ImGuiInputTextFlags_EnterReturnsTrue);
  record(result.widgets, "open-path");
  ImGui::SameLine();
  typed |= ImGui::Button("Open", {button, 0});
  record(result.widgets, "open-typed");
  ImGui::SameLine();
  // The text field has the keyboard, so that no shortcut sees the key.
  const bool closed = ImGui::Button("Close", {button, 0}) ||
                      ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape), false);
  record(result.widgets, "close-file-menu");
  if (typed && !menu.typed.empty()) result.open_paths = {menu.typed};
  if (closed || !result.open_paths.empty()) state.file_menu.reset();
}

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

void draw_weights(const ModelView& model, HandPose& hand, UiResult& result) {
  const std::vector<WeightRange> ranges = weight_ranges(model);
  for (std::size_t t = 0; t < ranges.size(); ++t) {
    const std::string name = "morph " + std::to_string(t);
    ImGui::SetNextItemWidth(-ImGui::GetFontSize() * 5);
    ImGui::SliderFloat(name.c_str(), &hand.pose.target_weights[t], ranges[t].min, ranges[t].max,
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
  colored_text(warning_color(),
               joint_name(skeleton, past) +
                   " is past its limit: the fuzzy boxes do not hold here, the picture is traced "
                   "with boxes of this pose alone (Refitted BVH)");
  ImGui::PopTextWrapPos();
  record(result.widgets, "past-limit");
}

}  // namespace

void draw_overlays(const Rect& picture, const Theme& theme, ViewState& state, UiResult& result) {
  if (!state.file && !state.baking && !state.help_open && !state.file_menu)
    draw_welcome(picture, theme);
  if (state.baking) draw_baking(picture, theme, *state.baking, result);
  if (!state.error.empty()) draw_error(picture, theme, state, result);
  if (!state.notice.empty()) draw_notice(picture, theme, state.notice);
  if (state.file_menu) draw_file_menu(picture, theme, state, result);
  if (state.help_open) draw_help(picture, theme, result);
}

void draw_pose_panel(const Rect& picture, const Theme& theme, ViewState& state, UiResult& result) {
  const ModelView* model = state.model();
  if (!model || model->skeleton.joints.empty()) return;
  const float margin = 14 * theme.scale;
  ImGui::SetNextWindowPos({picture.x + margin, picture.y + margin}, ImGuiCond_FirstUseEver);
  ImGui::SetNextWindowSize({250 * theme.scale, 0});
  const FloatingBox box("Skeleton", theme,
                        ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoSavedSettings |
                            ImGuiWindowFlags_AlwaysAutoResize |
                            ImGuiWindowFlags_NoFocusOnAppearing);
  HandPose& hand = state.hand;
  checkbox("Pose by hand", hand.active, result.widgets, "pose-by-hand");
  if (hand.active) {
    ImGui::SameLine(ImGui::GetWindowContentRegionMax().x - 60 * theme.scale);
    if (ImGui::Button("Rest", {60 * theme.scale, 0})) hand.pose = rest_pose_of(*model).pose;
    record(result.widgets, "pose-rest");
    draw_joints(model->skeleton, theme, hand, result);
    draw_turn(model->skeleton, hand, result);
    draw_weights(*model, hand, result);
    draw_limits(model->skeleton, hand, result);
  } else {
    ImGui::TextDisabled("%zu joints; shown is the clip", model->skeleton.joints.size());
  }
}

}  // namespace mdk
