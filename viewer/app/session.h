// Session: what mdview remembers from one run to the next, as a small JSON file.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "viewer/options.h"
#include "viewer/state/view_state.h"

namespace mdk {

struct SavedSession {
  std::optional<WindowSize> window;  ///< in window coordinates
  ViewSettings settings;
  LoopMode loop = LoopMode::kLoop;
  double speed = 1;
  PanelMode panel = PanelMode::kShown;
  std::vector<FileChoice> recent;

  bool operator==(const SavedSession&) const = default;
};

/// Where a session is kept: the file of --state, or else $XDG_STATE_HOME/mdview/session.json, or
/// else ~/.local/state/mdview/session.json. Empty where nothing is: --no-state, a scripted run
/// (--quit-after, --print-state), or no home.
std::string session_path(const ViewerOptions& options);

/// What is missing, damaged or out of range has its default; an empty path or a missing file gives
/// defaults. Never throws.
SavedSession read_session(const std::string& path);

/// What was remembered, into the state; and what of the state is to be.
void recall(const SavedSession& session, ViewState& state);
SavedSession session_to_keep(const ViewState& state, const WindowSize& window);

/// Makes the folder where need be. Returns whether it could be written; a viewer that cannot
/// remember is still a viewer.
bool write_session(const SavedSession& session, const std::string& path);

}  // namespace mdk
