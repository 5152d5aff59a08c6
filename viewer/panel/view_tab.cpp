#include <cmath>
#include <string>

#include "common/trace/technique.h"
#include "viewer/panel/heat_legend.h"
#include "viewer/panel/number_text.h"
#include "viewer/panel/tabs.h"
#include "viewer/panel/ui_parts.h"

namespace mdk {
namespace {

void draw_technique_row(std::size_t row, const Theme& theme, ViewState& state, UiResult& result) {
  const TechniqueInfo& info = technique_table()[row];
  const std::string id(info.id), label(info.label);
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  const float width = ImGui::GetContentRegionAvail().x;
  const float height = ImGui::GetTextLineHeight() + 3 * theme.scale;
  ImGui::PushID(id.c_str());
  if (ImGui::Selectable("##technique", state.settings.technique == row, 0, {width, height}))
    state.settings.technique = row;
  ImGui::PopID();
  record(result.widgets, "technique:" + id);
  if (ImGui::IsItemHovered()) {
    ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, ImVec2(8 * theme.scale, 5 * theme.scale));
    ImGui::BeginTooltip();
    ImGui::PushTextWrapPos(ImGui::GetFontSize() * 22);
    ImGui::Text("%s", std::string(info.summary).c_str());
    ImGui::TextDisabled("%s  ·  %s", id.c_str(), std::string(info.source).c_str());
    ImGui::PopTextWrapPos();
    ImGui::EndTooltip();
    ImGui::PopStyleVar();
  }

  ImDrawList& draw = *ImGui::GetWindowDrawList();
  const float text_y = corner.y + (height - ImGui::GetTextLineHeight()) / 2;
  const float middle = corner.y + height / 2, unit = theme.scale;
  const ImVec2 dot{corner.x + 11 * unit, middle};
  if (state.settings.technique == row)
    draw.AddCircleFilled(dot, 5 * unit, technique_color(row), 20);
  else
    draw.AddCircle(dot, 4.5f * unit, technique_color(row), 20, 1.8f * unit);
  draw.AddText({corner.x + 25 * unit, text_y}, text_color(), label.c_str());
  if (const auto median = state.history.median_ms(row)) {
    const std::string time = milliseconds_text(*median);
    draw.AddText({corner.x + width - ImGui::CalcTextSize(time.c_str()).x - 7 * unit, text_y},
                 dim_color(), time.c_str());
  }
}

void draw_techniques(const Theme& theme, ViewState& state, UiResult& result) {
  heading(theme, "TECHNIQUE");
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, ImVec2(0, 0));
  for (std::size_t row = 0; row < technique_table().size(); ++row)
    draw_technique_row(row, theme, state, result);
  ImGui::PopStyleVar();
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
