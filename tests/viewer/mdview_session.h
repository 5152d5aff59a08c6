// MdviewSession: the real mdview on an X server, with hands (xdotool) and eyes (--print-state).
#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tests/viewer/child_process.h"
#include "tests/viewer/x_server.h"

namespace mdk::test {

/// A point in the window, or a step.
struct Point {
  int x = 0, y = 0;
};

/// How a run ended.
struct MdviewResult {
  int status = -1;
  std::string messages;  ///< stderr
  nlohmann::json state;  ///< what --print-state said; null where it said nothing
};

class MdviewSession {
 public:
  /// Starts mdview in `folder` with `words` and --print-state. Its output goes to files there.
  MdviewSession(const XServer& server, const std::string& folder,
                const std::vector<std::string>& words);

  /// Waits until the window is there and has drawn its first pictures.
  void wait_for_window();

  void key(const std::string& name);
  void click(Point at);
  void drag(Point from, Point by, int button = 1);
  void wheel_up(Point at);
  void xdotool(std::vector<std::string> words);
  /// As xdotool(), whether or not there is a window left for it; the program's exit status.
  std::optional<int> try_xdotool(std::vector<std::string> words);

  bool running() { return process_->running(); }
  double cpu_seconds() const { return process_->cpu_seconds(); }
  /// Waits for the end. A run that does not end is a failure of the test.
  MdviewResult finish();
  /// As quit(), by the window's title bar, where a text field has the keyboard.
  MdviewResult close();
  /// Presses q and waits for the end.
  MdviewResult quit();

 private:
  void let_it_draw();

  std::string display_, folder_;
  std::unique_ptr<ChildProcess> process_;
};

/// Starts mdview without any display.
MdviewResult run_without_display(const std::string& folder, const std::vector<std::string>& words);

}  // namespace mdk::test
