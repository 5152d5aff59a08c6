// What the viewer's title bar tells while it runs: which file is open.
#pragma once

#include <string>

#include "tests/viewer/mdview_session.h"

namespace mdk::test {

/// Waits until that file is open and has been drawn.
inline void wait_for_file(MdviewSession& session, const std::string& name) {
  session.xdotool({"search", "--sync", "--name", "^" + name + " - mdview$"});
  session.xdotool({"sleep", "0.3"});
}

}  // namespace mdk::test
