#include "viewer/panel/style.h"

#include <array>
#include <filesystem>

namespace mdk {
namespace {

constexpr float kTextSize = 14.5f, kLargeSize = 25;

// The first folder that has the family; where none has, ImGui's built-in font serves.
constexpr std::array kFontFolders = {
    "/usr/share/fonts/truetype/dejavu/",
    "/usr/share/fonts/dejavu-sans-fonts/",
    "/usr/share/fonts/TTF/",
    "/usr/local/share/fonts/dejavu/",
};

// Latin, Greek and Cyrillic, for names in files, and the punctuation of our own sentences.
constexpr std::array<ImWchar, 7> kGlyphRanges = {0x20, 0x17f, 0x370, 0x52f, 0x2010, 0x2027, 0};

// ImGui 1.86 aborts on a font file that is missing: ask before.
ImFont* load(const char* file, float pixels) {
  ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
  for (const char* folder : kFontFolders) {
    const std::filesystem::path path = std::filesystem::path(folder) / file;
    std::error_code ignored;
    if (std::filesystem::is_regular_file(path, ignored))
      return atlas.AddFontFromFileTTF(path.c_str(), pixels, nullptr, kGlyphRanges.data());
  }
  ImFontConfig config;
  config.SizePixels = pixels;
  return atlas.AddFontDefault(&config);
}

ImVec4 rgb(int r, int g, int b, float alpha = 1) {
  return {static_cast<float>(r) / 255, static_cast<float>(g) / 255, static_cast<float>(b) / 255,
          alpha};
}

void set_colors(ImGuiStyle& style) {
  ImVec4* c = style.Colors;
  const ImVec4 accent = ImGui::ColorConvertU32ToFloat4(kAccentColor);
  const auto faded = [&](float alpha) { return ImVec4(accent.x, accent.y, accent.z, alpha); };
  c[ImGuiCol_Text] = ImGui::ColorConvertU32ToFloat4(kTextColor);
  c[ImGuiCol_TextDisabled] = ImGui::ColorConvertU32ToFloat4(kDimColor);
  c[ImGuiCol_WindowBg] = rgb(24, 26, 33);
  c[ImGuiCol_ChildBg] = rgb(24, 26, 33, 0);
  c[ImGuiCol_PopupBg] = rgb(32, 35, 44, 0.99f);
  c[ImGuiCol_Border] = rgb(255, 255, 255, 0.07f);
  c[ImGuiCol_FrameBg] = rgb(41, 45, 56);
  c[ImGuiCol_FrameBgHovered] = rgb(50, 55, 69);
  c[ImGuiCol_FrameBgActive] = rgb(57, 63, 80);
  c[ImGuiCol_Button] = rgb(41, 45, 56);
  c[ImGuiCol_ButtonHovered] = rgb(54, 60, 76);
  c[ImGuiCol_ButtonActive] = rgb(66, 74, 95);
  c[ImGuiCol_Header] = faded(0.20f);
  c[ImGuiCol_HeaderHovered] = faded(0.13f);
  c[ImGuiCol_HeaderActive] = faded(0.28f);
  c[ImGuiCol_CheckMark] = accent;
  c[ImGuiCol_PlotHistogram] = accent;
  c[ImGuiCol_SliderGrab] = accent;
  c[ImGuiCol_SliderGrabActive] = accent;
  c[ImGuiCol_Separator] = rgb(255, 255, 255, 0.07f);
  c[ImGuiCol_ScrollbarBg] = rgb(0, 0, 0, 0);
  c[ImGuiCol_ScrollbarGrab] = rgb(64, 70, 86);
  c[ImGuiCol_TextSelectedBg] = faded(0.35f);
}

}  // namespace

Theme make_theme(float scale, float pixel_ratio) {
  const float pixels = scale * pixel_ratio;  // fonts are made for the framebuffer, then shrunk
  Theme theme;
  theme.scale = scale;
  theme.fonts.text = load("DejaVuSans.ttf", kTextSize * pixels);
  theme.fonts.strong = load("DejaVuSans-Bold.ttf", kTextSize * pixels);
  theme.fonts.large = load("DejaVuSans.ttf", kLargeSize * pixels);
  ImGui::GetIO().FontGlobalScale = 1 / pixel_ratio;

  ImGui::StyleColorsDark();
  ImGuiStyle& style = ImGui::GetStyle();
  set_colors(style);
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
  return theme;
}

ImU32 technique_color(std::size_t technique) {
  constexpr std::array<ImU32, 11> kColors = {
      IM_COL32(92, 160, 255, 255),  IM_COL32(255, 170, 64, 255),  IM_COL32(92, 211, 141, 255),
      IM_COL32(232, 104, 160, 255), IM_COL32(170, 132, 255, 255), IM_COL32(72, 207, 214, 255),
      IM_COL32(236, 224, 92, 255),  IM_COL32(240, 112, 88, 255),  IM_COL32(152, 190, 96, 255),
      IM_COL32(204, 160, 128, 255), IM_COL32(160, 170, 190, 255)};
  return kColors[technique % kColors.size()];
}

ImU32 stage_color(std::size_t stage) {
  constexpr std::array<ImU32, 4> kColors = {
      IM_COL32(150, 126, 230, 255), IM_COL32(240, 162, 74, 255), IM_COL32(84, 150, 240, 255),
      IM_COL32(96, 196, 140, 255)};
  return kColors[stage % kColors.size()];
}

}  // namespace mdk
