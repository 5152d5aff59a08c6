// PlayedEvent: something a hand could do to the window, done by the program itself.
#pragma once

#include <string>

#include "viewer/commands.h"

namespace mdk {

enum class PlayedKind {
  kMove,     ///< the pointer, to x, y in window coordinates
  kPress,    ///< mouse button `number`
  kRelease,  ///< mouse button `number`
  kWheel,    ///< by x, y
  kKey,
  kDrop,    ///< the file or folder `path`
  kResize,  ///< the window, to x, y
};

struct PlayedEvent {
  PlayedKind kind = PlayedKind::kMove;
  float x = 0, y = 0;
  int number = 0;
  KeyEvent key;
  std::string path;
};

}  // namespace mdk
