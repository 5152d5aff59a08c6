#include "viewer/panel/overlays.h"

#include <algorithm>
#include <string>

#include "formats/file_kind.h"
#include "viewer/panel/file_menu.h"
#include "viewer/panel/ui_parts.h"

namespace mdk {
namespace {

constexpr ImGuiWindowFlags kFloating = ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize |
                                       ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                                       ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoNav |
                                       ImGuiWindowFlags_NoFocusOnAppearing;

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
  ImGui::SetNextWindowPos({picture.x + picture.width / 2, picture.y + picture.height / 2},
                          ImGuiCond_Always, {0.5f, 0.5f});
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
  const float width = std::min(picture.width, 380 * theme.scale);
  ImGui::SetNextWindowPos({picture.x + picture.width / 2, picture.y + picture.height / 2},
                          ImGuiCond_Always, {0.5f, 0.5f});
  ImGui::SetNextWindowSize({width, 0});
  ImGui::PushStyleColor(ImGuiCol_WindowBg, floating_color());
  ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 10 * theme.scale);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(20 * theme.scale, 16 * theme.scale));
  ImGui::Begin("##baking", nullptr, kFloating);
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
  ImGui::End();
  ImGui::PopStyleVar(2);
  ImGui::PopStyleColor();
}

void draw_error(const Rect& picture, const Theme& theme, ViewState& state, UiResult& result) {
  const float margin = 14 * theme.scale;
  ImGui::SetNextWindowPos({picture.x + margin, picture.y + margin});
  ImGui::SetNextWindowSize({std::max(80.0f, picture.width - 2 * margin), 0});
  ImGui::PushStyleColor(ImGuiCol_WindowBg, error_color());
  ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 8 * theme.scale);
  ImGui::Begin("##error", nullptr, kFloating);
  const float button = ImGui::GetFrameHeight();
  const float button_x = ImGui::GetWindowContentRegionMax().x - button;
  ImGui::PushTextWrapPos(button_x - margin);
  ImGui::AlignTextToFramePadding();
  ImGui::TextUnformatted(state.error.c_str());
  ImGui::PopTextWrapPos();
  record(result.widgets, "error");
  ImGui::SameLine(button_x);
  const bool dismissed = ImGui::Button("x", {button, 0});
  record(result.widgets, "dismiss-error");
  ImGui::End();
  ImGui::PopStyleVar();
  ImGui::PopStyleColor();
  if (dismissed) state.error.clear();
}

void draw_notice(const Rect& picture, const Theme& theme, const std::string& notice) {
  const float margin = 14 * theme.scale;
  ImGui::SetNextWindowPos({picture.x + margin, picture.y + picture.height - margin},
                          ImGuiCond_Always, {0, 1});
  ImGui::PushStyleColor(ImGuiCol_WindowBg, floating_color());
  ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 8 * theme.scale);
  ImGui::Begin("##notice", nullptr, kFloating | ImGuiWindowFlags_NoInputs);
  ImGui::TextUnformatted(notice.c_str());
  ImGui::End();
  ImGui::PopStyleVar();
  ImGui::PopStyleColor();
}

// In the middle of the picture where that is wide enough, else of the window; it scrolls where the
// window is too small for all.
void draw_help(const Rect& picture, const Theme& theme, UiResult& result) {
  const ImVec2 window = ImGui::GetIO().DisplaySize;
  const bool fits = picture.width >= kHelpWidth * theme.scale;
  ImGui::SetNextWindowPos({fits ? picture.x + picture.width / 2 : window.x / 2, window.y / 2},
                          ImGuiCond_Always, {0.5f, 0.5f});
  ImGui::SetNextWindowSizeConstraints({0, 0}, {std::max(1.0f, window.x), std::max(1.0f, window.y)});
  ImGui::PushStyleColor(ImGuiCol_WindowBg, floating_color());
  ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 10 * theme.scale);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(24 * theme.scale, 18 * theme.scale));
  ImGui::Begin("##help", nullptr, kFloating);
  ImGui::PushFont(theme.fonts.strong);
  ImGui::TextUnformatted("Keys and mouse");
  ImGui::PopFont();
  ImGui::Spacing();
  if (ImGui::BeginTable("##keys", 2, ImGuiTableFlags_SizingFixedFit)) {
    for (const ShortcutHelp& line : shortcut_help()) {
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
  ImGui::End();
  ImGui::PopStyleVar(2);
  ImGui::PopStyleColor();
}

}  // namespace

void draw_overlays(const Rect& picture, const Theme& theme, ViewState& state, UiResult& result) {
  if (!state.file && !state.baking && !state.help_open && !state.file_menu)
    draw_welcome(picture, theme);
  if (state.baking) draw_baking(picture, theme, *state.baking, result);
  if (!state.error.empty()) draw_error(picture, theme, state, result);
  if (!state.notice.empty()) draw_notice(picture, theme, state.notice);
  draw_file_menu(picture, theme, state, result);
  if (state.help_open) draw_help(picture, theme, result);
}

}  // namespace mdk
