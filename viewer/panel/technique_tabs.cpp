// Pages about techniques: View, Cost and Compare.
#include <algorithm>
#include <array>
#include <string>

#include "common/base/text.h"
#include "common/trace/technique.h"
#include "viewer/panel/charts.h"
#include "viewer/panel/panel.h"
#include "viewer/panel/tabs.h"
#include "viewer/panel/widgets.h"

namespace mdk {
namespace {

void draw_shading(const Theme& theme, ViewState& state, UiResult& result) {
  heading(theme, "SHADING");
  // Two rows: all of them side by side would leave no space for their names.
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
  if (state.frames.last && state.frames.last->heat.top > 0) {
    draw_heat_legend(theme, state.frames.last->heat);
    record(result.widgets, "heat-legend");
  }
}

void draw_camera(const Theme& theme, ViewState& state, UiResult& result) {
  heading(theme, "PICTURE");
  const std::vector<ButtonSegment> resolutions = {{"resolution:full", "1"},
                                                  {"resolution:half", "1/2"},
                                                  {"resolution:quarter", "1/4"},
                                                  {"resolution:auto", "Auto"}};
  choose(resolutions, state.settings.resolution, result.widgets);
  button_row({{"fit", "Fit", "All of the model in the picture (F)", Command::kFit},
              {"reset-view", "Reset", "Back to the first view (R)", Command::kResetView},
              {"save-picture", "Save",
               "Save the picture as PNG (P); C copies the mdprep command that makes it",
               Command::kSavePicture}},
             result);
  checkbox("Keep tracing while paused", state.settings.keep_tracing, result.widgets,
           "keep-tracing");
}

void draw_last_frame(const Theme& theme, const ViewState& state) {
  heading(theme, "THIS PICTURE");
  if (!state.frames.last) {
    ImGui::TextDisabled("none yet");
    return;
  }
  const FrameReport& frame = *state.frames.last;
  const FrameStats& stats = frame.stats;
  const double per_second =
      stats.trace_ms > 0 ? 1e3 * static_cast<double>(stats.rays) / stats.trace_ms : 0;
  const double hit_percent =
      stats.rays > 0 ? 100.0 * static_cast<double>(stats.hits) / static_cast<double>(stats.rays)
                     : 0;
  fact("Technique", std::string(technique_table()[frame.technique].label));
  fact("Size", std::to_string(frame.width) + " x " + std::to_string(frame.height));
  fact("Rays traced", rate_text(per_second) + "/s");
  fact("Hits", grouped_text(stats.hits) + "  (" + fixed_text(hit_percent, 0) + " %)");
  if (stats.light_rays > 0) fact("Rays to lights and sky", grouped_text(stats.light_rays));
  fact("Structures", bytes_text(frame.structure_bytes));
  fact("Built ahead of time", milliseconds_text(stats.prebuild_ms));
}

constexpr std::size_t kColumns = 5;
using Row = std::array<std::string, kColumns>;

Row time_row(const TechniqueCost& cost) {
  Row row;
  std::ranges::transform(frame_times(cost.frame.stats), row.begin(),
                         [](const FrameTime& time) { return short_number(time.ms); });
  return row;
}

Row work_row(const TechniqueCost& cost) {
  const FrameStats& s = cost.frame.stats;
  Row row;
  row[0] = s.trace_ms > 0 ? short_number(1e-3 * static_cast<double>(s.rays) / s.trace_ms) : "-";
  row[4] = short_number(static_cast<double>(cost.frame.structure_bytes) / (1 << 20));
  const auto per_ray = [&](std::uint64_t count) -> std::string {
    if (!cost.work || cost.work->rays == 0) return "-";
    const double each = static_cast<double>(count) / static_cast<double>(cost.work->rays);
    return fixed_text(each, each < 1 ? 3 : each < 99.95 ? 2 : 0);
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
    const float space = ImGui::GetContentRegionAvail().x - ImGui::CalcTextSize(text.c_str()).x;
    ImGui::SetCursorPosX(ImGui::GetCursorPosX() + space);
    colored_text(color, text);
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
    for (const auto& [technique, cost] : state.frames.by_technique) {
      ImGui::TableNextRow();
      ImGui::TableNextColumn();
      draw_technique_name(technique);
      record(result.widgets, "cost:" + std::string(technique_table()[technique].id));
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
  checkbox("Count the work", state.settings.count_work, result.widgets, "count-work",
           "Traces a separate counting frame now and then;\nits times are not shown.");
  choose({{"costs:times", "Time"}, {"costs:work", "Work"}}, state.settings.cost_columns,
         result.widgets);
  draw_table(theme, state, result);
}

void draw_modes(const Theme& theme, ViewState& state, UiResult& result) {
  heading(theme, "COMPARE");
  const std::vector<ButtonSegment> modes = {{"compare:off", "Off"},
                                            {"compare:side", "Side"},
                                            {"compare:wipe", "Wipe"},
                                            {"compare:difference", "Diff"}};
  choose(modes, state.compare.mode, result.widgets);
  ImGui::PushTextWrapPos(0);
  if (state.compare.mode == CompareMode::kOff) {
    ImGui::TextDisabled("A second technique traces the same view.");
  } else if (state.frames.last && state.frames.last->heat.top > 0) {
    ImGui::TextDisabled("Heat maps show the work, which differs.");
  } else if (state.frames.difference && state.frames.last) {
    const PictureDifference& found = *state.frames.difference;
    std::string text = difference_text(found, *state.frames.last);
    if (found.pixels > 0) text += ", by up to " + std::to_string(found.largest) + " of 255";
    colored_text(difference_color(found), text);
    record(result.widgets, "difference");
  }
  ImGui::PopTextWrapPos();
}

void draw_times_of_both(const Theme& theme, const ViewState& state) {
  if (!state.frames.last || !state.frames.second) return;
  heading(theme, "BOTH, IN MS");
  const FrameReport &first = *state.frames.last, &second = *state.frames.second;
  if (!ImGui::BeginTable("##both", 3, ImGuiTableFlags_RowBg)) return;
  ImGui::TableSetupColumn("##stage", ImGuiTableColumnFlags_WidthFixed, 60 * theme.scale);
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  for (const std::size_t technique : {first.technique, second.technique}) {
    ImGui::TableNextColumn();
    draw_technique_name(technique);
  }
  const auto times = frame_times(first.stats), second_times = frame_times(second.stats);
  for (std::size_t i = 0; i < times.size(); ++i) {
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::TextDisabled("%s", times[i].name);
    cell(short_number(times[i].ms));
    cell(short_number(second_times[i].ms));
  }
  ImGui::EndTable();
}

}  // namespace

void draw_view_tab(const Theme& theme, ViewState& state, UiResult& result) {
  heading(theme, "TECHNIQUE");
  state.settings.technique = draw_technique_list(theme, state.frames.history,
                                                 state.settings.technique, "technique:", result);
  draw_shading(theme, state, result);
  draw_camera(theme, state, result);
}

void draw_cost_tab(const Theme& theme, ViewState& state, UiResult& result) {
  draw_last_frame(theme, state);
  draw_techniques_tried(theme, state, result);
}

void draw_compare_tab(const Theme& theme, ViewState& state, UiResult& result) {
  draw_modes(theme, state, result);
  heading(theme, "AGAINST");
  state.compare.against =
      draw_technique_list(theme, state.frames.history, state.compare.against, "against:", result);
  if (state.compare.mode != CompareMode::kOff) draw_times_of_both(theme, state);
}

}  // namespace mdk
