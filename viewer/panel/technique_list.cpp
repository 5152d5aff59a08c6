#include "viewer/panel/technique_list.h"

#include <optional>
#include <string>

#include "common/trace/technique.h"
#include "viewer/panel/number_text.h"
#include "viewer/panel/ui_parts.h"

namespace mdk {
namespace {

struct Row {
  std::size_t technique;
  bool chosen;
  std::optional<double> median_ms;
};

// Whether it was clicked.
bool draw_row(const Row& row, const Theme& theme, const char* prefix, UiResult& result) {
  const TechniqueInfo& info = technique_table()[row.technique];
  const std::string id(info.id), label(info.label);
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  const float width = ImGui::GetContentRegionAvail().x;
  const float height = ImGui::GetTextLineHeight() + 3 * theme.scale;
  ImGui::PushID(id.c_str());
  const bool clicked = ImGui::Selectable("##technique", row.chosen, 0, {width, height});
  ImGui::PopID();
  record(result.widgets, prefix + id);
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
  if (row.chosen)
    draw.AddCircleFilled(dot, 5 * unit, technique_color(row.technique), 20);
  else
    draw.AddCircle(dot, 4.5f * unit, technique_color(row.technique), 20, 1.8f * unit);
  draw.AddText({corner.x + 25 * unit, text_y}, text_color(), label.c_str());
  if (row.median_ms) {
    const std::string time = milliseconds_text(*row.median_ms);
    draw.AddText({corner.x + width - ImGui::CalcTextSize(time.c_str()).x - 7 * unit, text_y},
                 dim_color(), time.c_str());
  }
  return clicked;
}

}  // namespace

std::size_t draw_technique_list(const Theme& theme, const FrameHistory& history, std::size_t chosen,
                                const char* prefix, UiResult& result) {
  std::size_t next = chosen;
  ImGui::PushID(prefix);
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, ImVec2(0, 0));
  for (std::size_t row = 0; row < technique_table().size(); ++row)
    if (draw_row({row, row == chosen, history.median_ms(row)}, theme, prefix, result)) next = row;
  ImGui::PopStyleVar();
  ImGui::PopID();
  return next;
}

}  // namespace mdk
