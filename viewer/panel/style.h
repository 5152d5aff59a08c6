// Style: fonts and colours of the panel.
#pragma once

#include <imgui.h>

#include <cstddef>

#include "viewer/state/settings.h"
#include "viewer/window/fonts.h"

namespace mdk {

/// What every panel function draws with.
struct Theme {
  Fonts fonts;
  float scale = 1;        ///< window coordinates per unit of design
  float pixel_ratio = 1;  ///< framebuffer pixels per window coordinate
};

/// Loads fonts, in place of those there are, and sets sizes and dark colours; rounded. Between
/// frames; after the first one Window::renew_fonts() is due as well.
Theme make_theme(float scale, float pixel_ratio);

/// Between frames, at any time.
void set_colors(ColorScheme scheme);

/// One colour per row of the technique table, the same wherever a technique is drawn.
ImU32 technique_color(std::size_t technique);

/// Colours of the parts of a frame: pose, update, trace, shade.
ImU32 stage_color(std::size_t stage);

// Those of the scheme that was set, for what the panel draws itself.
ImU32 accent_color();
ImU32 text_color();
ImU32 dim_color();
ImU32 sunken_color();
ImU32 line_color();
ImU32 error_color();
ImU32 warning_color();
ImU32 floating_color();
/// `color` with its opacity times `part`.
ImU32 faded(ImU32 color, float part);

}  // namespace mdk
