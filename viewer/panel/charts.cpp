#include "viewer/panel/charts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <span>
#include <string>

#include "common/base/text.h"
#include "common/trace/color.h"
#include "common/trace/technique.h"
#include "viewer/panel/widgets.h"

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

std::array<FrameTime, 5> frame_times(const FrameStats& stats) {
  return {FrameTime{"pose", stats.pose_ms}, FrameTime{"update", stats.update_ms},
          FrameTime{"trace", stats.trace_ms}, FrameTime{"shade", stats.shade_ms},
          FrameTime{"image", stats.time_to_image_ms()}};
}

void draw_stage_bar(const Theme& theme, const FrameStats& stats) {
  const auto times = frame_times(stats);
  const std::span stages(times.begin(), times.size() - 1);
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  const float width = ImGui::GetContentRegionAvail().x, height = 7 * theme.scale;
  const double total = times.back().ms;
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

void draw_heat_legend(const Theme& theme, const HeatScale& heat) {
  constexpr int kSteps = 48;
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  const float width = ImGui::GetContentRegionAvail().x, height = 9 * theme.scale;
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  for (int i = 0; i < kSteps; ++i) {
    const float left = corner.x + width * static_cast<float>(i) / kSteps;
    const float right = corner.x + width * static_cast<float>(i + 1) / kSteps;
    draw.AddRectFilled({left, corner.y}, {right, corner.y + height},
                       pack_srgb(heat_color((i + 0.5) / kSteps)));
  }
  ImGui::Dummy({width, height});

  const float text_y = corner.y + height + 2 * theme.scale;
  const auto text = [](double value) {
    std::array<char, 32> figure{};
    std::snprintf(figure.data(), figure.size(), "%g", value);
    return std::string(figure.data());
  };
  const auto label = [&](double share, const std::string& words) {
    const float space = width - ImGui::CalcTextSize(words.c_str()).x;
    draw.AddText({corner.x + space * static_cast<float>(share), text_y}, dim_color(),
                 words.c_str());
  };
  label(0, "0");
  label(0.5, text(heat.top / 2) + " " + std::string(heat.unit));
  label(1, text(heat.top));
  ImGui::Dummy({width, ImGui::GetTextLineHeight()});
}

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

void draw_technique_name(std::size_t technique) {
  colored_text(technique_color(technique), std::string(technique_table()[technique].label));
}

std::string difference_text(const PictureDifference& difference, const FrameReport& frame) {
  const std::uint64_t pixels = static_cast<std::uint64_t>(frame.width) * frame.height;
  return grouped_text(difference.pixels) + " of " + grouped_text(pixels) + " pixels differ";
}

ImU32 difference_color(const PictureDifference& difference) {
  return difference.pixels == 0 ? IM_COL32(96, 196, 140, 255) : warning_color();
}

}  // namespace mdk
