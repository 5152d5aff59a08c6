// XServer: an X server without a screen (Xvfb) for one test.
#pragma once

#include <memory>
#include <string>

#include "tests/viewer/child_process.h"

namespace mdk::test {

class XServer {
 public:
  /// The server picks a free display by itself, so that tests may run side by side. Throws
  /// std::runtime_error where it does not come up.
  XServer();

  /// Such as ":3".
  const std::string& display() const { return display_; }

 private:
  std::unique_ptr<ChildProcess> process_;
  std::string display_;
};

}  // namespace mdk::test
