// WidgetMap: where the widgets of the last drawn window are, so that scripts can click on them.
#pragma once

#include <map>
#include <string>

namespace mdk {

/// In window coordinates, from the upper left corner.
struct Rect {
  float x = 0, y = 0, width = 0, height = 0;

  bool contains(float px, float py) const {
    return x <= px && px < x + width && y <= py && py < y + height;
  }
  bool operator==(const Rect&) const = default;
};

/// By name, as in the "widgets" of --print-state.
using WidgetMap = std::map<std::string, Rect>;

}  // namespace mdk
