// The pages of the side panel. Choices act on the state at once, the rest is asked
// for in the result.
#pragma once

#include "viewer/panel/style.h"
#include "viewer/panel/widgets.h"
#include "viewer/state/view_state.h"

namespace mdk {

/// Technique, shading, resolution and camera.
void draw_view_tab(const Theme& theme, ViewState& state, UiResult& result);

/// What the last frame cost, and what every technique tried so far costs.
void draw_cost_tab(const Theme& theme, ViewState& state, UiResult& result);

/// A second technique compared with the first.
void draw_compare_tab(const Theme& theme, ViewState& state, UiResult& result);

/// Boxes over the picture, and the list of clusters with solo and hide.
void draw_clusters_tab(const Theme& theme, ViewState& state, UiResult& result);

/// The picked triangle: its cluster, its residual over the clip, its boxes.
void draw_pick_tab(const Theme& theme, ViewState& state, UiResult& result);

/// Facts of the file, saving pictures.
void draw_file_tab(const Theme& theme, ViewState& state, UiResult& result);

}  // namespace mdk
