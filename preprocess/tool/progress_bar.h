// Progress on stderr: one line redrawn in place on a terminal, a few plain lines elsewhere. Also a
// place where Ctrl-C takes effect (failure.h), since every long stage reports here.
#pragma once

#include <functional>
#include <iosfwd>
#include <string>
#include <string_view>

#include "common/base/parallel.h"
#include "common/base/stopwatch.h"

namespace mdk {

enum class ProgressStyle {
  kNone,
  kLines,  ///< a line per stage and per tenth of the job, but none for what took no time
  kBar,    ///< redrawn at most ten times a second
};

/// report() calls check_loop() (parallel.h), in every style. What is shown never goes back. Removes
/// its bar when it ends.
class ProgressBar final : public ProgressSink {
 public:
  /// Seconds since some moment; a test's own clock makes what is printed exact.
  using Clock = std::function<double()>;

  ProgressBar(std::ostream& out, ProgressStyle style)
      : ProgressBar(out, style, [watch = Stopwatch()] { return watch.seconds(); }) {}
  ProgressBar(std::ostream& out, ProgressStyle style, Clock clock)
      : out_(out), style_(style), clock_(std::move(clock)), start_(clock_()), drawn_(start_) {}
  ~ProgressBar() override { clear(); }
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void report(std::string_view stage, double fraction) override;

  /// Makes room for a message; a later report draws the bar again.
  void clear();

 private:
  bool due(std::string_view stage, double fraction, double now) const;

  std::ostream& out_;
  ProgressStyle style_;
  Clock clock_;
  double start_;
  double drawn_;  ///< when something was last drawn; at first, the start
  std::string drawn_stage_;
  double drawn_fraction_ = 0;
  double farthest_ = 0;
  bool bar_visible_ = false;
};

/// "[########------------]  42 %  decompose, 0:12 left"; `fraction` in [0, 1].
std::string progress_bar_text(std::string_view stage, double fraction, double elapsed_seconds);

/// " 42 %  decompose, 0:12 left". The estimate takes work to go on at its mean speed so far, and is
/// left out during the first second and the first two per cent.
std::string progress_line_text(std::string_view stage, double fraction, double elapsed_seconds);

}  // namespace mdk
