// UiResult: what one drawing of the window gathers besides pixels.
#pragma once

#include <string>
#include <vector>

#include "viewer/commands.h"
#include "viewer/state/widget_map.h"

namespace mdk {

struct UiResult {
  WidgetMap widgets;
  std::vector<Action> actions;          ///< asked for, to be done when the drawing is done
  std::vector<std::string> open_paths;  ///< an animation or a folder that was chosen, else empty
};

}  // namespace mdk
