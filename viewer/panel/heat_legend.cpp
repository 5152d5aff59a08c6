#include "viewer/panel/heat_legend.h"

#include <array>
#include <cstdio>
#include <string>

#include "common/trace/color.h"

namespace mdk {
namespace {

constexpr int kSteps = 48;

std::string number_text(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%g", value);
  return text.data();
}

}  // namespace

void draw_heat_legend(const Theme& theme, const HeatScale& heat) {
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
  const auto label = [&](double share, const std::string& text) {
    const float room = width - ImGui::CalcTextSize(text.c_str()).x;
    draw.AddText({corner.x + room * static_cast<float>(share), text_y}, dim_color(), text.c_str());
  };
  label(0, "0");
  label(0.5, number_text(heat.top / 2) + " " + std::string(heat.unit));
  label(1, number_text(heat.top));
  ImGui::Dummy({width, ImGui::GetTextLineHeight()});
}

}  // namespace mdk
