// Layout: where picture, time line and side panel lie in the window, and where its widgets are.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "viewer/state/settings.h"

namespace mdk {

/// In window coordinates, from the upper left corner.
struct Rect {
  float x = 0, y = 0, width = 0, height = 0;

  float right() const { return x + width; }
  float bottom() const { return y + height; }
  bool contains(float px, float py) const {
    return x <= px && px < right() && y <= py && py < bottom();
  }
  bool operator==(const Rect&) const = default;
};

/// The widgets of the last drawn window, so that scripts can click on them; by name, as in the
/// "widgets" of --print-state.
using WidgetMap = std::map<std::string, Rect>;

enum class PanelMode { kShown, kHidden };

struct Layout {
  Rect picture, time_line, side_panel;  ///< the last two are empty where the panel is hidden
};

/// The panel stands to the right of the picture and the time line below it, so that no ray is
/// traced that nobody sees. `scale`: 1 on an ordinary display. In a window too small for all, the
/// picture keeps at least half of each side.
Layout make_layout(float width, float height, float scale, PanelMode mode);

/// Whether the time line's controls, which one row would cut off, stand in two.
bool time_line_wraps(float width, float scale);

/// Where in the space for pictures each of them lies: two side by side, or one.
std::vector<Rect> picture_places(const Rect& space, CompareMode mode);

}  // namespace mdk
