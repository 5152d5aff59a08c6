#include <array>
#include <cstdio>
#include <string>

#include "common/trace/technique.h"
#include "viewer/panel/comparison_view.h"
#include "viewer/panel/number_text.h"
#include "viewer/panel/tabs.h"
#include "viewer/panel/technique_list.h"
#include "viewer/panel/ui_parts.h"

namespace mdk {
namespace {

void draw_modes(const Theme& theme, ViewState& state, UiResult& result) {
  heading(theme, "COMPARE");
  const std::vector<ButtonSegment> modes = {{"compare:off", "Off"},
                                            {"compare:side", "Side"},
                                            {"compare:wipe", "Wipe"},
                                            {"compare:difference", "Diff"}};
  const auto chosen = static_cast<std::size_t>(state.compare.mode);
  if (const auto picked = segmented_buttons(modes, chosen, result.widgets))
    state.compare.mode = static_cast<CompareMode>(*picked);
  ImGui::PushTextWrapPos(0);
  if (state.compare.mode == CompareMode::kOff) {
    ImGui::TextDisabled("A second technique traces the same view.");
  } else if (state.last_frame && state.last_frame->heat.top > 0) {
    ImGui::TextDisabled("Heat maps show the work, which differs.");
  } else if (state.difference && state.last_frame) {
    const bool same = state.difference->pixels == 0;
    std::string text = difference_text(*state.difference, *state.last_frame);
    if (!same) text += ", by up to " + std::to_string(state.difference->largest) + " of 255";
    ImGui::PushStyleColor(ImGuiCol_Text, same ? IM_COL32(96, 196, 140, 255) : warning_color());
    ImGui::TextUnformatted(text.c_str());
    ImGui::PopStyleColor();
    record(result.widgets, "difference");
  }
  ImGui::PopTextWrapPos();
}

void draw_times_of_both(const Theme& theme, const ViewState& state) {
  if (!state.last_frame || !state.second_frame) return;
  heading(theme, "BOTH, IN MS");
  const FrameReport &first = *state.last_frame, &second = *state.second_frame;
  const FrameStats &a = first.stats, &b = second.stats;
  struct Line {
    const char* name;
    double first, second;
  };
  const std::array<Line, 5> lines = {
      Line{"pose", a.pose_ms, b.pose_ms}, Line{"update", a.update_ms, b.update_ms},
      Line{"trace", a.trace_ms, b.trace_ms}, Line{"shade", a.shade_ms, b.shade_ms},
      Line{"image", a.time_to_image_ms(), b.time_to_image_ms()}};
  if (!ImGui::BeginTable("##both", 3, ImGuiTableFlags_RowBg)) return;
  ImGui::TableSetupColumn("##stage", ImGuiTableColumnFlags_WidthFixed, 60 * theme.scale);
  const auto label = [](std::size_t technique) {
    ImGui::TableNextColumn();
    ImGui::PushStyleColor(ImGuiCol_Text, technique_color(technique));
    ImGui::TextUnformatted(std::string(technique_table()[technique].label).c_str());
    ImGui::PopStyleColor();
  };
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  label(first.technique);
  label(second.technique);
  for (const Line& line : lines) {
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::TextDisabled("%s", line.name);
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(short_number(line.first).c_str());
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(short_number(line.second).c_str());
  }
  ImGui::EndTable();
}

}  // namespace

void draw_compare_tab(const Theme& theme, ViewState& state, UiResult& result) {
  draw_modes(theme, state, result);
  heading(theme, "AGAINST");
  state.compare.against =
      draw_technique_list(theme, state.history, state.compare.against, "against:", result);
  if (state.compare.mode != CompareMode::kOff) draw_times_of_both(theme, state);
}

}  // namespace mdk
