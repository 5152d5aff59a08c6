#include "viewer/panel/frame_charts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "common/trace/technique.h"
#include "viewer/panel/number_text.h"
#include "viewer/panel/ui_parts.h"

namespace mdk {
namespace {

// The smallest round number that is not below `value`.
double round_up_to_nice(double value) {
  if (!(value > 0)) return 1;
  const double decade = std::pow(10.0, std::floor(std::log10(value)));
  for (const double step : {1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0})
    if (value <= step * decade) return step * decade;
  return 10 * decade;
}

void draw_grid(const ImVec2& lo, const ImVec2& hi, double top_ms) {
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  ImFont* const font = ImGui::GetFont();
  const float size = ImGui::GetFontSize() * 0.76f;
  for (const double part : {0.5, 1.0}) {
    const float y = hi.y - static_cast<float>(part) * (hi.y - lo.y);
    draw.AddLine({lo.x, y}, {hi.x, y}, line_color());
    draw.AddText(font, size, {lo.x, y + 1}, dim_color(), milliseconds_text(part * top_ms).c_str());
  }
}

}  // namespace

void draw_stage_bar(const Theme& theme, std::span<const FrameStage> stages) {
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  const float width = ImGui::GetContentRegionAvail().x, height = 7 * theme.scale;
  double total = 0;
  for (const FrameStage& stage : stages) total += stage.ms;
  draw.AddRectFilled(corner, {corner.x + width, corner.y + height}, sunken_color(), height / 2);
  double done = 0;
  for (std::size_t i = 0; i < stages.size() && total > 0; ++i) {
    const float from = static_cast<float>(done / total) * width;
    done += stages[i].ms;
    const float to = static_cast<float>(done / total) * width;
    if (to - from >= 0.5f)
      draw.AddRectFilled({corner.x + from, corner.y}, {corner.x + to, corner.y + height},
                         stage_color(i), 2 * theme.scale);
  }
  ImGui::Dummy({width, height});

  const float column = width / 2, line = ImGui::GetTextLineHeight();
  for (std::size_t i = 0; i < stages.size(); ++i) {
    const bool left = i % 2 == 0;
    const float x = ImGui::GetWindowContentRegionMin().x + (left ? 0 : column + 6 * theme.scale);
    if (!left) ImGui::SameLine();
    ImGui::SetCursorPosX(x);
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float box = 8 * theme.scale;
    draw.AddRectFilled({at.x, at.y + (line - box) / 2}, {at.x + box, at.y + (line + box) / 2},
                       stage_color(i), 2 * theme.scale);
    ImGui::SetCursorPosX(x + 15 * theme.scale);
    ImGui::TextDisabled("%s", stages[i].name);
    const std::string time = milliseconds_text(stages[i].ms);
    ImGui::SameLine();
    ImGui::SetCursorPosX(x + column - 6 * theme.scale - ImGui::CalcTextSize(time.c_str()).x);
    ImGui::TextUnformatted(time.c_str());
  }
}

void draw_history_plot(const Theme& theme, const FrameHistory& history) {
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  const ImVec2 lo = ImGui::GetCursorScreenPos();
  const ImVec2 size{ImGui::GetContentRegionAvail().x, 46 * theme.scale};
  const ImVec2 hi{lo.x + size.x, lo.y + size.y};
  hit_area("##history", size);
  const bool hovered = ImGui::IsItemHovered();
  draw.AddRectFilled(lo, hi, sunken_color(), 5 * theme.scale);

  const float inset = 5 * theme.scale;
  const ImVec2 plot_lo{lo.x + inset, lo.y + inset}, plot_hi{hi.x - inset, hi.y - inset};
  const auto& samples = history.samples();
  if (samples.empty()) return;
  const double top_ms = round_up_to_nice(history.longest_ms());
  // Whole pixels, or the columns would flicker as they move.
  const float column = std::max(
      2.0f, std::floor((plot_hi.x - plot_lo.x) / static_cast<float>(FrameHistory::kCapacity)));
  const float first = std::floor(plot_hi.x) - column * static_cast<float>(samples.size());
  draw.PushClipRect(plot_lo, plot_hi, true);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const float x = first + column * static_cast<float>(i);
    const auto part = static_cast<float>(samples[i].time_to_image_ms / top_ms);
    const float y = plot_hi.y - std::max(1.0f, part * (plot_hi.y - plot_lo.y));
    draw.AddRectFilled({x, y}, {x + column, plot_hi.y}, technique_color(samples[i].technique));
  }
  draw.PopClipRect();
  draw_grid(plot_lo, plot_hi, top_ms);

  const float pointed = (ImGui::GetIO().MousePos.x - first) / column;
  if (hovered && pointed >= 0 && pointed < static_cast<float>(samples.size())) {
    const FrameSample& sample = samples[static_cast<std::size_t>(pointed)];
    ImGui::SetTooltip("%s: %s", std::string(technique_table()[sample.technique].label).c_str(),
                      milliseconds_text(sample.time_to_image_ms).c_str());
  }
}

}  // namespace mdk
