// TimeTrack: the clip as a strip to scrub along: keys, segments, the chosen range, and what
// pictures cost.
//
//     range lane   |      [=========]          |   drag: choose a range, or move an end of it
//     keys         |  '   '   '   |   '   '   '|   drag: the time
//     cost         |  ___---___----____        |
//     segments     |===============|===========|   where there are several
#pragma once

#include "viewer/panel/side_panel.h"

namespace mdk {

/// Fills what is left of the present ImGui window. Dragging holds the time; letting go plays on.
void draw_time_track(const Theme& theme, ViewState& state, UiResult& result);

}  // namespace mdk
