#include <array>
#include <cstdio>
#include <string>

#include "common/base/figure_text.h"
#include "formats/file_kind.h"
#include "viewer/panel/tabs.h"
#include "viewer/panel/ui_parts.h"

namespace mdk {
namespace {

void draw_facts(const Theme& theme, const ViewState& state) {
  heading(theme, "FILE");
  const Model* model = state.model();
  if (!model) {
    ImGui::TextDisabled("Drop an animation on the window.");
    return;
  }
  std::array<char, 32> seconds{};
  std::snprintf(seconds.data(), seconds.size(), "%.3g s", state.playback.seconds());
  fact("Triangles", grouped_text(model->triangle_count()));
  fact("Vertices", grouped_text(model->vertex_count));
  fact("Clips", grouped_text(model->clips.size()));
  fact("Keys", grouped_text(model->key_count()));
  fact("This clip", seconds.data());
  fact("Clusters", grouped_text(model->cluster_count()));
  fact("Time segments", grouped_text(model->segment_count()));
  fact("Joints to pose", grouped_text(model->skeleton.joints.size()));
  fact("Textures", grouped_text(model->appearance.textures.size()));
  fact("Size", bytes_text(state.file->file_bytes()));
}

void draw_saving(const Theme& theme, UiResult& result) {
  heading(theme, "SAVE");
  button_row(
      {{"save-picture-as-png", "Picture", "The picture alone, as PNG (P)", Command::kSavePicture},
       {"save-window", "Window", "The whole window, as PNG (Shift + P)", Command::kSaveWindow},
       {"copy-command", "Command",
        "Copy the mdprep render command that makes this picture, to the pixel (C)",
        Command::kCopyCommand}},
      result);
}

void draw_export(const Theme& theme, ViewState& state, UiResult& result) {
  heading(theme, "EXPORT");
  ExportSettings& settings = state.export_settings;
  if (settings.films_possible) {
    const auto picked =
        segmented_buttons({{"export-pictures", "Pictures"}, {"export-film", "Film"}},
                          static_cast<std::size_t>(settings.kind), result.widgets);
    if (picked) settings.kind = static_cast<ExportKind>(*picked);
  }
  if (state.exporting) {
    ImGui::ProgressBar(static_cast<float>(state.exporting->fraction), {-1, 6 * theme.scale}, "");
    record(result.widgets, "export-progress");
    button_row(
        {{"cancel-export", "Cancel", "Takes away what was written (Esc)", Command::kCancelExport}},
        result);
    return;
  }
  const bool part = state.playback.range().has_value();
  button_row({{"export", part ? "Export the range" : "Export the clip",
               "Every key as seen now, by mdprep in the background, into the present folder (E)",
               Command::kExport}},
             result);
}

void draw_opening(const Theme& theme, const ViewState& state, UiResult& result) {
  heading(theme, "OPEN");
  std::vector<CommandButton> buttons = {
      {"open", "Open or recent", "Recent files, or a path (L)", Command::kToggleFileMenu}};
  if (state.file && file_kind(state.path) != FileKind::kBaked)
    buttons.push_back({"keep-baked", "Keep as .mdk",
                       "Write what was baked beside its source: that opens at once",
                       Command::kKeepBaked});
  button_row(buttons, result);
}

void draw_window_choices(const Theme& theme, ViewState& state, UiResult& result) {
  heading(theme, "WINDOW");
  const auto picked =
      segmented_buttons({{"theme:dark", "Dark"}, {"theme:light", "Light"}},
                        static_cast<std::size_t>(state.settings.colors), result.widgets);
  if (picked) state.settings.colors = static_cast<ColorScheme>(*picked);
  ImGui::Checkbox("Turntable", &state.turntable);
  record(result.widgets, "turntable");
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("The camera goes slowly round (T)");
  const float room = ImGui::GetContentRegionAvail().x, gap = ImGui::GetStyle().ItemSpacing.x;
  ImGui::SameLine(ImGui::GetCursorPosX() + (room + gap) / 2);
  button_row({{"text-smaller", "Text -", "Smaller text and buttons (-)", Command::kSmallerText},
              {"text-larger", "Text +", "Larger text and buttons (+)", Command::kLargerText}},
             result);
}

}  // namespace

void draw_file_tab(const Theme& theme, ViewState& state, UiResult& result) {
  draw_facts(theme, state);
  draw_opening(theme, state, result);
  draw_saving(theme, result);
  draw_export(theme, state, result);
  draw_window_choices(theme, state, result);
}

}  // namespace mdk
