// Style: fonts and colours of the panel.
#pragma once

#include <imgui.h>

#include <cstddef>

namespace mdk {

struct Fonts {
  ImFont* text = nullptr;
  ImFont* strong = nullptr;
  ImFont* large = nullptr;
};

/// What every panel function draws with.
struct Theme {
  Fonts fonts;
  float scale = 1;  ///< window coordinates per unit of design
};

/// Loads fonts and sets colours and sizes: dark, rounded. `scale` as Window::ui_scale(),
/// `pixel_ratio` as Window::pixel_ratio(). Call once, before the first frame.
Theme make_theme(float scale, float pixel_ratio);

/// One colour per row of the technique table, the same wherever a technique is drawn.
ImU32 technique_color(std::size_t technique);

/// Colours of the parts of a frame: pose, update, trace, shade.
ImU32 stage_color(std::size_t stage);

inline constexpr ImU32 kAccentColor = IM_COL32(92, 160, 255, 255);
inline constexpr ImU32 kTextColor = IM_COL32(226, 230, 238, 255);
inline constexpr ImU32 kDimColor = IM_COL32(139, 147, 163, 255);
inline constexpr ImU32 kSunkenColor = IM_COL32(16, 18, 23, 255);
inline constexpr ImU32 kLineColor = IM_COL32(255, 255, 255, 22);
inline constexpr ImU32 kErrorColor = IM_COL32(122, 38, 44, 245);
inline constexpr ImU32 kWarningColor = IM_COL32(240, 190, 90, 255);
inline constexpr ImU32 kFloatingColor = IM_COL32(30, 33, 41, 245);

}  // namespace mdk
