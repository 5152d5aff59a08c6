// SidePanel: the file's name, one of the pages (tabs.h), and the last frame's time, which is in
// sight whichever page is open.
#pragma once

#include "viewer/panel/style.h"
#include "viewer/panel/ui_result.h"
#include "viewer/state/view_state.h"

namespace mdk {

/// Draws the panel into `place`; choices act on `state` at once, the rest is asked for in `result`.
/// A page that is higher than its room scrolls.
void draw_side_panel(const Rect& place, const Theme& theme, ViewState& state, UiResult& result);

}  // namespace mdk
