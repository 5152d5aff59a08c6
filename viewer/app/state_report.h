// StateReport: what the viewer shows, as the JSON object of --print-state.
#pragma once

#include <cstdint>
#include <string>

#include "viewer/state/view_state.h"

namespace mdk {

/// Facts of the window that are not in the ViewState.
struct WindowReport {
  std::uint64_t frames_shown = 0, window_draws = 0;
  float width = 0, height = 0;
  WidgetMap widgets;
  double first_picture_ms = 0;  ///< after the program began; 0: none was shown
  double open_ms = 0;  ///< from asking for the file that is open to its first picture; 0: none yet
  std::string render_command;  ///< makes the picture again, with mdprep
};

/// One line. Names are stable; times in seconds, stats as in `mdprep bench --json`; what is not
/// known is null.
std::string state_json(const ViewState& state, const WindowReport& window);

}  // namespace mdk
