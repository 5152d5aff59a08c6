// Commands: everything a key or a button can ask for, and the table of keys. The help overlay shows
// this table, so that it cannot lie.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

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
  kBeginRange,  ///< at the present time
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

/// A key that was pressed or a character that was typed; the other one is 0. Letters and signs are
/// taken as characters, so that they follow the keyboard's layout.
struct KeyEvent {
  int key = 0;  ///< GLFW_KEY_...
  unsigned character = 0;
};

std::optional<Action> action_for(const KeyEvent& event);

/// Every key and character that does something, by the name the help gives it, digits aside.
std::vector<std::string> bound_keys();

struct ShortcutHelp {
  const char* keys;
  const char* does;
};

/// Keys, then the mouse.
std::span<const ShortcutHelp> shortcut_help();

}  // namespace mdk
