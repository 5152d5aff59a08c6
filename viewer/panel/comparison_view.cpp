#include "viewer/panel/comparison_view.h"

#include <algorithm>
#include <string>

#include "common/base/figure_text.h"
#include "common/trace/technique.h"
#include "viewer/panel/number_text.h"
#include "viewer/panel/ui_parts.h"

namespace mdk {
namespace {

std::string title_of(const FrameReport& frame) {
  return std::string(technique_table()[frame.technique].label) + "   " +
         milliseconds_text(frame.stats.time_to_image_ms());
}

// A text on a plate; its right edge at `right` where that is given, else its left edge at `left`.
struct Plate {
  float left = 0, top = 0;
  bool ends_there = false;  ///< `left` is where it ends
};

void draw_plate(const Theme& theme, const Plate& plate, const std::string& text, ImU32 dot) {
  ImDrawList& draw = *ImGui::GetBackgroundDrawList();
  const ImVec2 size = ImGui::CalcTextSize(text.c_str());
  const float pad = 8 * theme.scale, mark = 14 * theme.scale;
  const float width = size.x + mark + 2 * pad, height = size.y + pad;
  const float x = plate.ends_there ? plate.left - width : plate.left;
  draw.AddRectFilled({x, plate.top}, {x + width, plate.top + height}, floating_color(),
                     6 * theme.scale);
  draw.AddCircleFilled({x + pad + 4 * theme.scale, plate.top + height / 2}, 4.5f * theme.scale, dot,
                       20);
  draw.AddText({x + pad + mark, plate.top + pad / 2}, text_color(), text.c_str());
}

void draw_divider(const Rect& picture, const Theme& theme, CompareSettings& compare,
                  UiResult& result) {
  const float grip = 16 * theme.scale;
  const float x = picture.x + compare.divider * picture.width;
  ImGui::SetNextWindowPos({x - grip / 2, picture.y});
  ImGui::SetNextWindowSize({grip, picture.height});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(0, 0));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowMinSize, ImVec2(1, 1));
  ImGui::Begin("##divider", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoBackground |
                   ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                   ImGuiWindowFlags_NoNav | ImGuiWindowFlags_NoFocusOnAppearing |
                   ImGuiWindowFlags_NoBringToFrontOnFocus);
  hit_area("##grip", {grip, picture.height});
  record(result.widgets, "divider");
  const bool held = ImGui::IsItemActive(), warm = held || ImGui::IsItemHovered();
  if (warm) ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeEW);
  if (held)
    compare.divider =
        std::clamp((ImGui::GetIO().MousePos.x - picture.x) / picture.width, 0.0f, 1.0f);
  ImGui::End();
  ImGui::PopStyleVar(2);

  ImDrawList& draw = *ImGui::GetBackgroundDrawList();
  const float now = picture.x + compare.divider * picture.width;
  const float middle = picture.y + picture.height / 2, handle = 18 * theme.scale;
  draw.AddLine({now, picture.y}, {now, picture.y + picture.height}, IM_COL32(0, 0, 0, 120),
               4 * theme.scale);
  draw.AddLine({now, picture.y}, {now, picture.y + picture.height},
               warm ? accent_color() : IM_COL32(255, 255, 255, 230), 2 * theme.scale);
  draw.AddRectFilled({now - 4 * theme.scale, middle - handle},
                     {now + 4 * theme.scale, middle + handle},
                     warm ? accent_color() : IM_COL32(255, 255, 255, 230), 4 * theme.scale);
}

}  // namespace

std::string difference_text(const PictureDifference& difference, const FrameReport& frame) {
  const std::uint64_t pixels = static_cast<std::uint64_t>(frame.width) * frame.height;
  return grouped_text(difference.pixels) + " of " + grouped_text(pixels) + " pixels differ";
}

void draw_comparison(const Rect& picture, const Theme& theme, ViewState& state, UiResult& result) {
  CompareSettings& compare = state.compare;
  if (compare.mode == CompareMode::kOff || !state.file) return;
  if (compare.mode == CompareMode::kWipe) draw_divider(picture, theme, compare, result);
  if (!state.last_frame || !state.second_frame) return;
  const FrameReport &first = *state.last_frame, &second = *state.second_frame;
  const float margin = 12 * theme.scale, top = picture.y + margin;
  const ImU32 first_dot = technique_color(first.technique);
  const ImU32 second_dot = technique_color(second.technique);
  if (compare.mode == CompareMode::kDifference) {
    draw_plate(theme, {picture.x + margin, top}, difference_text(*state.difference, first),
               state.difference->pixels == 0 ? IM_COL32(96, 196, 140, 255) : warning_color());
    return;
  }
  draw_plate(theme, {picture.x + margin, top}, title_of(first), first_dot);
  if (compare.mode == CompareMode::kWipe) {
    draw_plate(theme, {picture.x + picture.width - margin, top, true}, title_of(second),
               second_dot);
    return;
  }
  const float middle = picture.x + picture.width / 2;
  draw_plate(theme, {middle + margin, top}, title_of(second), second_dot);
  ImGui::GetBackgroundDrawList()->AddLine({middle, picture.y}, {middle, picture.y + picture.height},
                                          IM_COL32(0, 0, 0, 140), 2 * theme.scale);
}

}  // namespace mdk
