// The pages of the side panel, one file each. Choices act on the state at once, the rest is asked
// for in the result.
#pragma once

#include "viewer/panel/style.h"
#include "viewer/panel/ui_result.h"
#include "viewer/state/view_state.h"

namespace mdk {

/// Technique, shading, resolution and camera.
void draw_view_tab(const Theme& theme, ViewState& state, UiResult& result);

/// What the last frame cost, and what every technique tried so far costs.
void draw_cost_tab(const Theme& theme, ViewState& state, UiResult& result);

/// Facts of the file, saving pictures.
void draw_file_tab(const Theme& theme, ViewState& state, UiResult& result);

}  // namespace mdk
