#include "viewer/panel/side_panel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>

#include "common/trace/technique.h"
#include "viewer/panel/frame_charts.h"
#include "viewer/panel/heat_legend.h"
#include "viewer/panel/number_text.h"
#include "viewer/panel/ui_parts.h"

namespace mdk {
namespace {

void draw_file_facts(const Theme& theme, const ViewState& state) {
  ImGui::PushFont(theme.fonts.strong);
  ImGui::TextUnformatted(state.file ? state.file_name.c_str() : "No file");
  ImGui::PopFont();
  const Model* model = state.model();
  if (!model) {
    ImGui::TextDisabled("drop an animation on the window");
    return;
  }
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", state.file->path().c_str());
  const std::string mesh = grouped(model->triangle_count()) + " triangles, " +
                           grouped(model->vertex_count) + " vertices";
  const std::string motion = grouped(model->key_count()) + " keys, " +
                             grouped(model->cluster_count()) + " clusters, " +
                             bytes_text(state.file->file_bytes());
  ImGui::TextDisabled("%s", mesh.c_str());
  ImGui::TextDisabled("%s", motion.c_str());
}

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
  if (state.last_frame && state.last_frame->heat.top > 0)
    draw_heat_legend(theme, state.last_frame->heat);
}

void draw_frame_times(const Theme& theme, const ViewState& state) {
  heading(theme, "LAST FRAME");
  if (!state.last_frame) {
    ImGui::TextDisabled("none yet");
    return;
  }
  const FrameReport& frame = *state.last_frame;
  const FrameStats& stats = frame.stats;
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

  const std::array<FrameStage, 4> stages = {FrameStage{"pose", stats.pose_ms},
                                            {"update", stats.update_ms},
                                            {"trace", stats.trace_ms},
                                            {"shade", stats.shade_ms}};
  draw_stage_bar(theme, stages);

  const double per_second =
      stats.trace_ms > 0 ? 1e3 * static_cast<double>(stats.rays) / stats.trace_ms : 0;
  const double hit_percent =
      stats.rays > 0 ? 100.0 * static_cast<double>(stats.hits) / static_cast<double>(stats.rays)
                     : 0;
  std::array<char, 64> hits{};
  std::snprintf(hits.data(), hits.size(), "%s  (%.0f %%)", grouped(stats.hits).c_str(),
                hit_percent);
  fact("Rays traced", rate_text(per_second) + "/s");
  fact("Hits", hits.data());
  fact("Picture", std::to_string(frame.width) + " x " + std::to_string(frame.height));
  fact("Structures", bytes_text(frame.structure_bytes));
  if (!frame.note.empty()) {
    ImGui::PushTextWrapPos(0);
    ImGui::TextDisabled("Chosen: %s", frame.note.c_str());
    ImGui::PopTextWrapPos();
  }
}

void draw_work(const Theme& theme, ViewState& state, UiResult& result) {
  heading(theme, "WORK PER RAY");
  ImGui::Checkbox("Count", &state.settings.count_work);
  record(result.widgets, "count-work");
  if (ImGui::IsItemHovered())
    ImGui::SetTooltip("Traces a separate counting frame now and then;\nits times are not shown.");
  const auto& work = state.last_work;
  const bool known = state.settings.count_work && work && work->rays > 0 &&
                     work->technique == state.settings.technique;
  const auto per_ray = [&](std::uint64_t count) -> std::string {
    if (!known) return "-";
    std::array<char, 32> text{};
    const double each = static_cast<double>(count) / static_cast<double>(work->rays);
    std::snprintf(text.data(), text.size(), "%.*f", each < 1 ? 3 : 2, each);
    return text.data();
  };
  const TraceCounters counters = work ? work->counters : TraceCounters{};
  fact("Node visits", per_ray(counters.node_visits));
  fact("Triangle tests", per_ray(counters.triangle_tests));
  fact("Clusters entered", per_ray(counters.clusters_entered));
}

void draw_history(const Theme& theme, const ViewState& state, UiResult& result) {
  heading(theme, "TIME TO IMAGE");
  draw_history_plot(theme, state.history);
  record(result.widgets, "history");
}

void draw_view(const Theme& theme, ViewState& state, UiResult& result) {
  heading(theme, "VIEW");
  const std::vector<ButtonSegment> resolutions = {{"resolution:full", "1"},
                                                  {"resolution:half", "1/2"},
                                                  {"resolution:quarter", "1/4"},
                                                  {"resolution:auto", "Auto"}};
  const auto chosen = static_cast<std::size_t>(state.settings.resolution);
  if (const auto picked = segmented_buttons(resolutions, chosen, result.widgets))
    state.settings.resolution = static_cast<Resolution>(*picked);
  const float gap = ImGui::GetStyle().ItemSpacing.x;
  const float third = std::floor((ImGui::GetContentRegionAvail().x - 2 * gap) / 3);
  const auto button = [&](const char* label, const char* tip, Command command) {
    if (ImGui::Button(label, {third, 0})) result.actions.push_back({command});
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", tip);
  };
  button("Fit", "All of the model in the picture (F)", Command::kFit);
  record(result.widgets, "fit");
  ImGui::SameLine();
  button("Reset", "Back to the first view (R)", Command::kResetView);
  record(result.widgets, "reset-view");
  ImGui::SameLine();
  button("Save", "Save the picture as PNG (P); C copies the mdprep command that makes it",
         Command::kSavePicture);
  record(result.widgets, "save-picture");
  ImGui::Checkbox("Keep tracing while paused", &state.settings.keep_tracing);
  record(result.widgets, "keep-tracing");
  const float help_width = ImGui::GetFrameHeight();
  ImGui::SameLine(ImGui::GetWindowContentRegionMax().x - help_width);
  if (ImGui::Button("?", {help_width, 0})) result.actions.push_back({Command::kToggleHelp});
  record(result.widgets, "help");
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("Keys and mouse");
}

}  // namespace

void draw_side_panel(const Rect& place, const Theme& theme, ViewState& state, UiResult& result) {
  ImGui::SetNextWindowPos({place.x, place.y});
  ImGui::SetNextWindowSize({place.width, place.height});
  ImGui::Begin("##side", nullptr,
               ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                   ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoBringToFrontOnFocus |
                   ImGuiWindowFlags_NoNav);
  draw_file_facts(theme, state);
  draw_techniques(theme, state, result);
  draw_shading(theme, state, result);
  draw_view(theme, state, result);
  draw_frame_times(theme, state);
  draw_work(theme, state, result);
  draw_history(theme, state, result);
  ImGui::End();
}

}  // namespace mdk
