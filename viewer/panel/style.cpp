#include "viewer/panel/style.h"

#include <array>

namespace mdk {
namespace {

ImVec4 rgb(int r, int g, int b, float alpha = 1) {
  return {static_cast<float>(r) / 255, static_cast<float>(g) / 255, static_cast<float>(b) / 255,
          alpha};
}

// Our own colours stand in ImGui's table too, in places of widgets that the panel has none of:
// one table then holds a whole scheme.
constexpr ImGuiCol kSunkenSlot = ImGuiCol_MenuBarBg, kLineSlot = ImGuiCol_TableBorderLight,
                   kErrorSlot = ImGuiCol_DragDropTarget,
                   kWarningSlot = ImGuiCol_PlotHistogramHovered, kFloatingSlot = ImGuiCol_PopupBg;

struct SchemeColor {
  ImGuiCol slot;
  ImVec4 dark, light;
};

const std::array kSchemeColors = {
    SchemeColor{ImGuiCol_Text, rgb(226, 230, 238), rgb(30, 34, 43)},
    SchemeColor{ImGuiCol_TextDisabled, rgb(139, 147, 163), rgb(98, 106, 122)},
    SchemeColor{ImGuiCol_WindowBg, rgb(24, 26, 33), rgb(240, 242, 246)},
    SchemeColor{ImGuiCol_Border, rgb(255, 255, 255, 0.07f), rgb(0, 0, 0, 0.14f)},
    SchemeColor{ImGuiCol_FrameBg, rgb(41, 45, 56), rgb(218, 222, 230)},
    SchemeColor{ImGuiCol_FrameBgHovered, rgb(50, 55, 69), rgb(207, 213, 224)},
    SchemeColor{ImGuiCol_FrameBgActive, rgb(57, 63, 80), rgb(196, 203, 217)},
    SchemeColor{ImGuiCol_Button, rgb(41, 45, 56), rgb(218, 222, 230)},
    SchemeColor{ImGuiCol_ButtonHovered, rgb(54, 60, 76), rgb(203, 209, 221)},
    SchemeColor{ImGuiCol_ButtonActive, rgb(66, 74, 95), rgb(186, 195, 212)},
    SchemeColor{ImGuiCol_CheckMark, rgb(92, 160, 255), rgb(26, 104, 214)},
    SchemeColor{ImGuiCol_ScrollbarGrab, rgb(64, 70, 86), rgb(178, 186, 200)},
    SchemeColor{kSunkenSlot, rgb(16, 18, 23), rgb(226, 229, 236)},
    SchemeColor{kLineSlot, rgb(255, 255, 255, 0.09f), rgb(0, 0, 0, 0.12f)},
    SchemeColor{kErrorSlot, rgb(122, 38, 44, 0.96f), rgb(250, 208, 208, 0.97f)},
    SchemeColor{kWarningSlot, rgb(240, 190, 90), rgb(160, 92, 0)},
    SchemeColor{kFloatingSlot, rgb(30, 33, 41, 0.97f), rgb(250, 251, 253, 0.97f)},
};

ImU32 darker(ImU32 color) {
  ImVec4 c = ImGui::ColorConvertU32ToFloat4(color);
  for (float* part : {&c.x, &c.y, &c.z}) *part *= 0.72f;
  return ImGui::ColorConvertFloat4ToU32(c);
}

// What stands out on dark would be pale on light.
ImU32 plotted(ImU32 color) {
  const ImVec4& ground = ImGui::GetStyle().Colors[ImGuiCol_WindowBg];
  return ground.x < 0.5f ? color : darker(color);
}

}  // namespace

Theme make_theme(float scale, float pixel_ratio) {
  const float pixels = scale * pixel_ratio;  // fonts are made for the framebuffer, then shrunk
  Theme theme;
  theme.scale = scale;
  theme.pixel_ratio = pixel_ratio;
  theme.fonts = load_fonts(*ImGui::GetIO().Fonts, pixels);
  ImGui::GetIO().FontGlobalScale = 1 / pixel_ratio;

  ImGuiStyle& style = ImGui::GetStyle() = ImGuiStyle();
  style.WindowPadding = {14, 12};
  style.FramePadding = {9, 4};
  style.ItemSpacing = {8, 6};
  style.ItemInnerSpacing = {7, 4};
  style.WindowRounding = 0;
  style.ChildRounding = style.FrameRounding = style.GrabRounding = 5;
  style.PopupRounding = 7;
  style.ScrollbarSize = 11;
  style.ScrollbarRounding = 6;
  style.WindowBorderSize = 0;
  style.PopupBorderSize = 1;
  style.ScaleAllSizes(scale);
  set_colors(ColorScheme::kDark);
  return theme;
}

void set_colors(ColorScheme scheme) {
  ImVec4* c = ImGui::GetStyle().Colors;
  const bool dark = scheme == ColorScheme::kDark;
  dark ? ImGui::StyleColorsDark() : ImGui::StyleColorsLight();
  for (const SchemeColor& color : kSchemeColors) c[color.slot] = dark ? color.dark : color.light;
  const ImVec4 accent = c[ImGuiCol_CheckMark];
  const auto see_through = [&](float alpha) { return ImVec4(accent.x, accent.y, accent.z, alpha); };
  c[ImGuiCol_ChildBg] = c[ImGuiCol_ScrollbarBg] = {0, 0, 0, 0};
  c[ImGuiCol_Header] = see_through(0.20f);
  c[ImGuiCol_HeaderHovered] = see_through(0.13f);
  c[ImGuiCol_HeaderActive] = see_through(0.28f);
  c[ImGuiCol_PlotHistogram] = c[ImGuiCol_SliderGrab] = c[ImGuiCol_SliderGrabActive] = accent;
  c[ImGuiCol_Separator] = c[ImGuiCol_Border];
  c[ImGuiCol_TextSelectedBg] = see_through(0.35f);
}

ImU32 technique_color(std::size_t technique) {
  constexpr std::array<ImU32, 11> kColors = {
      IM_COL32(92, 160, 255, 255),  IM_COL32(255, 170, 64, 255),  IM_COL32(92, 211, 141, 255),
      IM_COL32(232, 104, 160, 255), IM_COL32(170, 132, 255, 255), IM_COL32(72, 207, 214, 255),
      IM_COL32(236, 224, 92, 255),  IM_COL32(240, 112, 88, 255),  IM_COL32(152, 190, 96, 255),
      IM_COL32(204, 160, 128, 255), IM_COL32(160, 170, 190, 255)};
  return plotted(kColors[technique % kColors.size()]);
}

ImU32 stage_color(std::size_t stage) {
  constexpr std::array<ImU32, 4> kColors = {
      IM_COL32(150, 126, 230, 255), IM_COL32(240, 162, 74, 255), IM_COL32(84, 150, 240, 255),
      IM_COL32(96, 196, 140, 255)};
  return plotted(kColors[stage % kColors.size()]);
}

ImU32 accent_color() { return ImGui::GetColorU32(ImGuiCol_CheckMark); }
ImU32 text_color() { return ImGui::GetColorU32(ImGuiCol_Text); }
ImU32 dim_color() { return ImGui::GetColorU32(ImGuiCol_TextDisabled); }
ImU32 sunken_color() { return ImGui::GetColorU32(kSunkenSlot); }
ImU32 line_color() { return ImGui::GetColorU32(kLineSlot); }
ImU32 error_color() { return ImGui::GetColorU32(kErrorSlot); }
ImU32 warning_color() { return ImGui::GetColorU32(kWarningSlot); }
ImU32 floating_color() { return ImGui::GetColorU32(kFloatingSlot); }

ImU32 faded(ImU32 color, float part) {
  ImVec4 c = ImGui::ColorConvertU32ToFloat4(color);
  c.w *= part;
  return ImGui::ColorConvertFloat4ToU32(c);
}

}  // namespace mdk
