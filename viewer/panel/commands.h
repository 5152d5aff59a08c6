// Commands: everything a key or a button can ask for, and the table of keys. The help overlay shows
// this table, so that it tells the truth.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "viewer/window/window.h"

namespace mdk {

enum class Command {
  kPlayPause,
  kPreviousKey,
  kNextKey,
  kStart,
  kEnd,
  kPreviousTechnique,
  kNextTechnique,
  kTechniqueByNumber,
  kNextShading,
  kNextCompare,
  kShowAll,  ///< clusters
  kFit,
  kResetView,
  kSavePicture,
  kSaveWindow,
  kCopyCommand,  ///< the mdprep render command line of the picture, to the clipboard
  kExport,       ///< the range, else the clip
  kCancelExport,
  kToggleFileMenu,
  kKeepBaked,  ///< writes what was baked beside its source
  kCancelBake,
  kBeginRange,  ///< at the current time
  kEndRange,
  kClearRange,
  kToggleTurntable,
  kToggleColors,
  kLargerText,
  kSmallerText,
  kTogglePanel,
  kToggleHelp,
  kDismiss,  ///< closes what stands open, or cancels what is in work; else quits
  kQuit,
};

struct Action {
  Command command;
  std::size_t number = 0;  ///< of kTechniqueByNumber: row of the table
};

/// A key or a character and what it asks for.
struct Binding {
  KeyEvent event;
  Command command;
};

/// A line of the help.
struct Shortcut {
  const char* keys;
  const char* does;
  std::vector<Binding> bindings;  ///< none of the mouse's and of the digits'
};

/// Keys, then the mouse.
std::span<const Shortcut> shortcuts();

std::optional<Action> action_for(const KeyEvent& event);

}  // namespace mdk
