#include <array>
#include <cstdio>
#include <string>

#include "viewer/panel/number_text.h"
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
  fact("Triangles", grouped(model->triangle_count()));
  fact("Vertices", grouped(model->vertex_count));
  fact("Clips", grouped(model->clips.size()));
  fact("Keys", grouped(model->key_count()));
  fact("This clip", seconds.data());
  fact("Clusters", grouped(model->cluster_count()));
  fact("Time segments", grouped(model->segment_count()));
  fact("Joints to pose", grouped(model->skeleton.joints.size()));
  fact("Textures", grouped(model->textures.size()));
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

}  // namespace

void draw_file_tab(const Theme& theme, ViewState& state, UiResult& result) {
  draw_facts(theme, state);
  draw_saving(theme, result);
}

}  // namespace mdk
