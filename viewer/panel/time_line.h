// TimeLine: the bar below the picture: play, step, loop, speed, clip, and the keys to scrub along.
#pragma once

#include "viewer/panel/style.h"
#include "viewer/panel/ui_result.h"
#include "viewer/state/view_state.h"

namespace mdk {

/// Draws the bar into `place`; choices act on `state` at once, the rest is asked for in `result`.
void draw_time_line(const Rect& place, const Theme& theme, ViewState& state, UiResult& result);

}  // namespace mdk
