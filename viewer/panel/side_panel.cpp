// The side panel: header, tab bar, the open page, and the last frame below it.
#include <algorithm>
#include <string>

#include "viewer/panel/charts.h"
#include "viewer/panel/tabs.h"
#include "viewer/panel/widgets.h"

namespace mdk {
namespace {

constexpr float kMinPageHeight = 160, kGoodPageHeight = 240;
constexpr float kFooterHeight = 176, kShortFooterHeight = 72;  // without a note

void draw_header(const Theme& theme, const ViewState& state, UiResult& result) {
  const float help_width = ImGui::GetFrameHeight();
  ImGui::PushFont(theme.fonts.strong);
  ImGui::AlignTextToFramePadding();
  ImGui::TextUnformatted(state.file ? state.file_name.c_str() : "No file");
  ImGui::PopFont();
  if (state.file && ImGui::IsItemHovered()) ImGui::SetTooltip("%s", state.path.c_str());
  ImGui::SameLine(ImGui::GetWindowContentRegionMax().x - help_width);
  if (ImGui::Button("?", {help_width, 0})) result.actions.push_back({Command::kToggleHelp});
  record(result.widgets, "help", "Keys and mouse");
}

// Tabs share the width: each gets its label's and an equal part of what is left.
void draw_tab_bar(const Theme& theme, ViewState& state, UiResult& result) {
  const auto tabs = panel_tab_table();
  const float width = ImGui::GetContentRegionAvail().x;
  float labels = 0;
  for (const PanelTabInfo& info : tabs)
    labels += ImGui::CalcTextSize(std::string(info.label).c_str()).x;
  const float air = (width - labels) / static_cast<float>(tabs.size());
  const float height = ImGui::GetFrameHeight() + 2 * theme.scale;
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  const float bottom = corner.y + height;
  draw.AddLine({corner.x, bottom}, {corner.x + width, bottom}, line_color(), theme.scale);
  for (const PanelTabInfo& info : tabs) {
    const std::string id(info.id), label(info.label);
    const ImVec2 text = ImGui::CalcTextSize(label.c_str());
    if (info.tab != tabs.front().tab) ImGui::SameLine(0, 0);
    const ImVec2 lo = ImGui::GetCursorScreenPos();
    const ImVec2 size{text.x + air, height};
    if (hit_area(("##tab:" + id).c_str(), size)) state.tab = info.tab;
    record(result.widgets, "tab:" + id);
    const bool open = state.tab == info.tab, hovered = ImGui::IsItemHovered();
    draw.AddText({lo.x + air / 2, lo.y + (height - text.y) / 2},
                 open || hovered ? text_color() : dim_color(), label.c_str());
    if (open)
      draw.AddRectFilled({lo.x, bottom - 2 * theme.scale}, {lo.x + size.x, bottom}, accent_color(),
                         theme.scale);
    if (hovered) ImGui::SetTooltip("%s", std::string(info.summary).c_str());
  }
}

void draw_page(const Theme& theme, ViewState& state, UiResult& result) {
  switch (state.tab) {
    case PanelTab::kView:
      return draw_view_tab(theme, state, result);
    case PanelTab::kCost:
      return draw_cost_tab(theme, state, result);
    case PanelTab::kCompare:
      return draw_compare_tab(theme, state, result);
    case PanelTab::kClusters:
      return draw_clusters_tab(theme, state, result);
    case PanelTab::kPick:
      return draw_pick_tab(theme, state, result);
    case PanelTab::kFile:
      return draw_file_tab(theme, state, result);
  }
}

// What the technique chose, where it chooses.
std::string note_of(const ViewState& state) {
  if (!state.frames.last || state.frames.last->note.empty()) return {};
  return "Chosen: " + state.frames.last->note;
}

float note_height(const std::string& note) {
  if (note.empty()) return 0;
  const float wrap = ImGui::GetContentRegionAvail().x;
  return ImGui::CalcTextSize(note.c_str(), nullptr, false, wrap).y +
         ImGui::GetStyle().ItemSpacing.y;
}

/// Where there is little space, the page needs it more than the charts do.
enum class Footer { kWhole, kShort };

void draw_footer(const Theme& theme, const ViewState& state, Footer footer, UiResult& result) {
  heading(theme, "LAST FRAME");
  if (!state.frames.last) {
    ImGui::TextDisabled("none yet");
    return;
  }
  const FrameStats& stats = state.frames.last->stats;
  ImGui::PushFont(theme.fonts.large);
  ImGui::TextUnformatted(milliseconds_text(stats.time_to_image_ms()).c_str());
  ImGui::PopFont();
  const float after_number = ImGui::GetItemRectMax().x - ImGui::GetWindowPos().x;
  ImGui::SameLine(after_number + 10 * theme.scale);
  ImGui::BeginGroup();
  ImGui::TextDisabled("time to image");
  if (state.shown_per_second > 0)
    ImGui::TextDisabled("%.0f shown per second", state.shown_per_second);
  else
    ImGui::TextDisabled("at rest");
  ImGui::EndGroup();
  if (footer == Footer::kWhole) draw_stage_bar(theme, stats);
  if (const std::string note = note_of(state); !note.empty()) {
    dim_paragraph(note);
    record(result.widgets, "chosen");
  }
  if (footer == Footer::kShort) return;
  draw_history_plot(theme, state.frames.history);
  record(result.widgets, "history");
}

}  // namespace

void draw_side_panel(const Rect& place, const Theme& theme, ViewState& state, UiResult& result) {
  begin_docked("##side", place);
  draw_header(theme, state, result);
  draw_tab_bar(theme, state, result);

  const float room = ImGui::GetContentRegionAvail().y - ImGui::GetStyle().ItemSpacing.y -
                     note_height(note_of(state));
  const bool has_room = room >= (kGoodPageHeight + kFooterHeight) * theme.scale;
  const Footer footer = has_room ? Footer::kWhole : Footer::kShort;
  const float footer_height = (has_room ? kFooterHeight : kShortFooterHeight) * theme.scale;
  const float height = std::max(kMinPageHeight * theme.scale, room - footer_height);
  // A page of its own for each tab, so that each keeps its place.
  ImGui::BeginChild(std::string(panel_tab_id(state.tab)).c_str(), {0, height});
  draw_page(theme, state, result);
  const ImVec2 corner = ImGui::GetWindowPos(), size = ImGui::GetWindowSize();
  result.widgets["page"] = {corner.x, corner.y, size.x, size.y};
  result.widgets["page-content"] = {corner.x, corner.y - ImGui::GetScrollY(), size.x,
                                    ImGui::GetCursorPosY() - ImGui::GetStyle().ItemSpacing.y};
  ImGui::EndChild();
  draw_footer(theme, state, footer, result);
  ImGui::End();
}

}  // namespace mdk
