#include <array>
#include <cstdio>
#include <string>

#include "common/base/figure_text.h"
#include "common/trace/technique.h"
#include "viewer/panel/number_text.h"
#include "viewer/panel/tabs.h"
#include "viewer/panel/ui_parts.h"

namespace mdk {
namespace {

std::string count_text(double each) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.*f", each < 1 ? 3 : each < 99.95 ? 2 : 0, each);
  return text.data();
}

void draw_last_frame(const Theme& theme, const ViewState& state) {
  heading(theme, "THIS PICTURE");
  if (!state.last_frame) {
    ImGui::TextDisabled("none yet");
    return;
  }
  const FrameReport& frame = *state.last_frame;
  const FrameStats& stats = frame.stats;
  const double per_second =
      stats.trace_ms > 0 ? 1e3 * static_cast<double>(stats.rays) / stats.trace_ms : 0;
  const double hit_percent =
      stats.rays > 0 ? 100.0 * static_cast<double>(stats.hits) / static_cast<double>(stats.rays)
                     : 0;
  std::array<char, 64> hits{};
  std::snprintf(hits.data(), hits.size(), "%s  (%.0f %%)", grouped_text(stats.hits).c_str(),
                hit_percent);
  fact("Technique", std::string(technique_table()[frame.technique].label));
  fact("Size", std::to_string(frame.width) + " x " + std::to_string(frame.height));
  fact("Rays traced", rate_text(per_second) + "/s");
  fact("Hits", hits.data());
  if (stats.light_rays > 0) fact("Rays to lights and sky", grouped_text(stats.light_rays));
  fact("Structures", bytes_text(frame.structure_bytes));
  fact("Built ahead of time", milliseconds_text(stats.prebuild_ms));
}

constexpr std::size_t kColumns = 5;
using Row = std::array<std::string, kColumns>;

Row time_row(const TechniqueCost& cost) {
  const FrameStats& s = cost.frame.stats;
  return {short_number(s.pose_ms), short_number(s.update_ms), short_number(s.trace_ms),
          short_number(s.shade_ms), short_number(s.time_to_image_ms())};
}

Row work_row(const TechniqueCost& cost) {
  const FrameStats& s = cost.frame.stats;
  Row row;
  row[0] = s.trace_ms > 0 ? short_number(1e-3 * static_cast<double>(s.rays) / s.trace_ms) : "-";
  row[4] = short_number(static_cast<double>(cost.frame.structure_bytes) / (1 << 20));
  const auto per_ray = [&](std::uint64_t count) -> std::string {
    if (!cost.work || cost.work->rays == 0) return "-";
    return count_text(static_cast<double>(count) / static_cast<double>(cost.work->rays));
  };
  const TraceCounters counters = cost.work ? cost.work->counters : TraceCounters{};
  row[1] = per_ray(counters.node_visits);
  row[2] = per_ray(counters.triangle_tests);
  row[3] = per_ray(counters.clusters_entered);
  return row;
}

void draw_table(const Theme& theme, ViewState& state, UiResult& result) {
  const bool times = state.settings.cost_columns == CostColumns::kTimes;
  constexpr std::array kTimeTitles = {"pose", "update", "trace", "shade", "image"};
  constexpr std::array kWorkTitles = {"Mray/s", "nodes", "tests", "clust.", "MiB"};
  const auto& titles = times ? kTimeTitles : kWorkTitles;
  const float number = 47 * theme.scale;
  const auto right_text = [&](const std::string& text, ImU32 color) {
    const float room = ImGui::GetContentRegionAvail().x - ImGui::CalcTextSize(text.c_str()).x;
    ImGui::SetCursorPosX(ImGui::GetCursorPosX() + room);
    ImGui::PushStyleColor(ImGuiCol_Text, color);
    ImGui::TextUnformatted(text.c_str());
    ImGui::PopStyleColor();
  };
  ImGui::PushStyleVar(ImGuiStyleVar_CellPadding, ImVec2(0, theme.scale));
  if (ImGui::BeginTable("##costs", 1 + static_cast<int>(kColumns), ImGuiTableFlags_RowBg)) {
    ImGui::TableSetupColumn("##name", ImGuiTableColumnFlags_WidthStretch);
    for (const char* title : titles)
      ImGui::TableSetupColumn(title, ImGuiTableColumnFlags_WidthFixed, number);
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::TextDisabled("%s", times ? "ms" : "per ray");
    for (const char* title : titles) {
      ImGui::TableNextColumn();
      right_text(title, dim_color());
    }
    for (const auto& [technique, cost] : state.costs) {
      const TechniqueInfo& info = technique_table()[technique];
      ImGui::TableNextRow();
      ImGui::TableNextColumn();
      ImGui::PushStyleColor(ImGuiCol_Text, technique_color(technique));
      ImGui::TextUnformatted(std::string(info.label).c_str());
      ImGui::PopStyleColor();
      record(result.widgets, "cost:" + std::string(info.id));
      for (const std::string& text : times ? time_row(cost) : work_row(cost)) {
        ImGui::TableNextColumn();
        right_text(text, text_color());
      }
    }
    ImGui::EndTable();
  }
  ImGui::PopStyleVar();
}

void draw_techniques_tried(const Theme& theme, ViewState& state, UiResult& result) {
  heading(theme, "TECHNIQUES TRIED");
  ImGui::Checkbox("Count the work", &state.settings.count_work);
  record(result.widgets, "count-work");
  if (ImGui::IsItemHovered())
    ImGui::SetTooltip("Traces a separate counting frame now and then;\nits times are not shown.");
  const std::vector<ButtonSegment> columns = {{"costs:times", "Time"}, {"costs:work", "Work"}};
  const auto chosen = static_cast<std::size_t>(state.settings.cost_columns);
  if (const auto picked = segmented_buttons(columns, chosen, result.widgets))
    state.settings.cost_columns = static_cast<CostColumns>(*picked);
  draw_table(theme, state, result);
}

}  // namespace

void draw_cost_tab(const Theme& theme, ViewState& state, UiResult& result) {
  draw_last_frame(theme, state);
  draw_techniques_tried(theme, state, result);
}

}  // namespace mdk
