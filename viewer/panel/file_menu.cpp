#include "viewer/panel/file_menu.h"

#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>

#include "viewer/panel/ui_parts.h"

namespace mdk {
namespace {

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

}  // namespace

void draw_file_menu(const Rect& picture, const Theme& theme, ViewState& state, UiResult& result) {
  if (!state.file_menu) return;
  FileMenu& menu = *state.file_menu;
  ImGui::SetNextWindowPos({picture.x + picture.width / 2, picture.y + picture.height / 2},
                          ImGuiCond_Always, {0.5f, 0.5f});
  ImGui::SetNextWindowSize({std::min(picture.width, 560 * theme.scale), 0});
  ImGui::PushStyleColor(ImGuiCol_WindowBg, floating_color());
  ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 10 * theme.scale);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(20 * theme.scale, 16 * theme.scale));
  ImGui::Begin("##file-menu", nullptr,
               ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                   ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoNav);
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
  ImGui::End();
  ImGui::PopStyleVar(2);
  ImGui::PopStyleColor();
  if (closed || !result.open_paths.empty()) state.file_menu.reset();
}

}  // namespace mdk
