// SidePanel: techniques, shading, times and counts of the last frame, view and file facts.
#pragma once

#include <vector>

#include "viewer/commands.h"
#include "viewer/panel/style.h"
#include "viewer/state/view_state.h"
#include "viewer/state/widget_map.h"

namespace mdk {

/// What one drawing of the window gathers besides pixels.
struct UiResult {
  WidgetMap widgets;
  std::vector<Action> actions;
};

/// Draws the panel into `place`; choices act on `state` at once, the rest is asked for in `result`.
void draw_side_panel(const Rect& place, const Theme& theme, ViewState& state, UiResult& result);

}  // namespace mdk
