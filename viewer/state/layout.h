// Layout: where picture, time line and side panel lie in the window.
#pragma once

#include "viewer/state/widget_map.h"

namespace mdk {

enum class PanelMode { kShown, kHidden };

struct Layout {
  Rect picture, time_line, side_panel;  ///< the last two are empty where the panel is hidden
};

/// The panel stands to the right of the picture and the time line below it, so that no ray is
/// traced that nobody sees. `scale`: 1 on an ordinary display. In a window too small for all, the
/// picture keeps at least half of each side.
Layout make_layout(float width, float height, float scale, PanelMode mode);

}  // namespace mdk
