#include <string>

#include "viewer/panel/heat_legend.h"
#include "viewer/panel/tabs.h"
#include "viewer/panel/technique_list.h"
#include "viewer/panel/ui_parts.h"

namespace mdk {
namespace {

void draw_techniques(const Theme& theme, ViewState& state, UiResult& result) {
  heading(theme, "TECHNIQUE");
  state.settings.technique =
      draw_technique_list(theme, state.history, state.settings.technique, "technique:", result);
}

void draw_shading(const Theme& theme, ViewState& state, UiResult& result) {
  heading(theme, "SHADING");
  // Two rows: all of them side by side would leave no room for their names.
  const std::span<const ShadingInfo> modes = shading_table();
  const std::size_t half = (modes.size() + 1) / 2;
  for (const auto& row : {modes.first(half), modes.subspan(half)}) {
    std::vector<ButtonSegment> segments;
    std::size_t chosen = row.size();
    for (const ShadingInfo& info : row) {
      if (info.mode == state.settings.shading) chosen = segments.size();
      segments.push_back({"shading:" + std::string(info.id), std::string(info.label)});
    }
    if (const auto picked = segmented_buttons(segments, chosen, result.widgets))
      state.settings.shading = row[*picked].mode;
  }
  if (state.last_frame && state.last_frame->heat.top > 0) {
    draw_heat_legend(theme, state.last_frame->heat);
    record(result.widgets, "heat-legend");
  }
}

void draw_camera(const Theme& theme, ViewState& state, UiResult& result) {
  heading(theme, "PICTURE");
  const std::vector<ButtonSegment> resolutions = {{"resolution:full", "1"},
                                                  {"resolution:half", "1/2"},
                                                  {"resolution:quarter", "1/4"},
                                                  {"resolution:auto", "Auto"}};
  const auto chosen = static_cast<std::size_t>(state.settings.resolution);
  if (const auto picked = segmented_buttons(resolutions, chosen, result.widgets))
    state.settings.resolution = static_cast<Resolution>(*picked);
  button_row({{"fit", "Fit", "All of the model in the picture (F)", Command::kFit},
              {"reset-view", "Reset", "Back to the first view (R)", Command::kResetView},
              {"save-picture", "Save",
               "Save the picture as PNG (P); C copies the mdprep command that makes it",
               Command::kSavePicture}},
             result);
  ImGui::Checkbox("Keep tracing while paused", &state.settings.keep_tracing);
  record(result.widgets, "keep-tracing");
}

}  // namespace

void draw_view_tab(const Theme& theme, ViewState& state, UiResult& result) {
  draw_techniques(theme, state, result);
  draw_shading(theme, state, result);
  draw_camera(theme, state, result);
}

}  // namespace mdk
