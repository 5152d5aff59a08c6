#include "preprocess/tool/progress_bar.h"

#include <algorithm>
#include <cmath>
#include <ostream>

#include "common/base/parallel.h"

namespace mdk {
namespace {

constexpr double kRedrawSeconds = 0.1;
constexpr double kStageSeconds = 0.3;
constexpr double kLineSeconds = 2;
constexpr const char* kClearLine = "\r\x1b[K";

std::string percent_text(double fraction) {
  const std::string digits = std::to_string(static_cast<int>(fraction * 100));
  return std::string(digits.size() < 3 ? 3 - digits.size() : 0, ' ') + digits + " %";
}

int tenths(double fraction) { return static_cast<int>(fraction * 10); }

std::string clock_text(double seconds) {
  const long long total = std::llround(std::min(seconds, 3.6e6));
  const std::string rest = std::to_string(total % 60);
  return std::to_string(total / 60) + (rest.size() < 2 ? ":0" : ":") + rest;
}

}  // namespace

std::string progress_line_text(std::string_view stage, double fraction, double elapsed_seconds) {
  std::string text = percent_text(fraction) + "  " + std::string(stage);
  if (elapsed_seconds >= 1 && fraction >= 0.02 && fraction < 1)
    text += ", " + clock_text(elapsed_seconds * (1 - fraction) / fraction) + " left";
  return text;
}

std::string progress_bar_text(std::string_view stage, double fraction, double elapsed_seconds) {
  constexpr std::size_t kWidth = 24;
  const auto done = static_cast<std::size_t>(fraction * kWidth);
  std::string text = "[";
  text.append(done, '#').append(kWidth - done, '-').append("] ");
  return text + progress_line_text(stage, fraction, elapsed_seconds);
}

bool ProgressBar::due(std::string_view stage, double fraction, double now) const {
  const double waited = now - drawn_;
  switch (style_) {
    case ProgressStyle::kNone:
      return false;
    case ProgressStyle::kBar:
      return waited >= kRedrawSeconds || drawn_stage_.empty();
    case ProgressStyle::kLines:
      return stage != drawn_stage_
                 ? waited >= kStageSeconds
                 : waited >= kLineSeconds && tenths(fraction) > tenths(drawn_fraction_);
  }
  return false;
}

void ProgressBar::report(std::string_view stage, double fraction) {
  check_loop();
  // A stage that starts again at 0 must not pull the bar back.
  const double shown = fraction > farthest_ ? std::min(fraction, 1.0) : farthest_;
  farthest_ = shown;
  const double now = clock_();
  if (!due(stage, shown, now)) return;
  drawn_stage_ = stage;
  drawn_fraction_ = shown;
  drawn_ = now;
  if (style_ == ProgressStyle::kBar) {
    out_ << kClearLine << progress_bar_text(stage, shown, now - start_) << std::flush;
    bar_visible_ = true;
  } else {
    out_ << "mdprep: " << progress_line_text(stage, shown, now - start_) << "\n" << std::flush;
  }
}

void ProgressBar::clear() {
  if (!bar_visible_) return;
  out_ << kClearLine << std::flush;
  bar_visible_ = false;
}

}  // namespace mdk
