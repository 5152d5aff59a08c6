#include "preprocess/cli/progress_bar.h"

#include <algorithm>
#include <cmath>
#include <ostream>

#include "preprocess/cli/interrupt.h"

namespace mdk {
namespace {

constexpr double kRedrawSeconds = 0.1;
constexpr double kStageSeconds = 0.3;
constexpr double kLineSeconds = 2;
constexpr double kLineStep = 0.1;
constexpr const char* kClearLine = "\r\x1b[K";

std::string percent_text(double fraction) {
  const std::string digits = std::to_string(static_cast<int>(fraction * 100));
  return std::string(digits.size() < 3 ? 3 - digits.size() : 0, ' ') + digits + " %";
}

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
  constexpr int kWidth = 24;
  const int done = static_cast<int>(fraction * kWidth);
  return "[" + std::string(static_cast<std::size_t>(done), '#') +
         std::string(static_cast<std::size_t>(kWidth - done), '-') + "] " +
         progress_line_text(stage, fraction, elapsed_seconds);
}

bool ProgressBar::due(std::string_view stage, double fraction) const {
  if (style_ == ProgressStyle::kNone) return false;
  if (drawn_fraction_ < 0) return true;
  const double seconds = since_drawn_.seconds();
  if (style_ == ProgressStyle::kBar) return seconds >= kRedrawSeconds;
  if (stage != drawn_stage_) return seconds >= kStageSeconds;
  return fraction >= drawn_fraction_ + kLineStep && seconds >= kLineSeconds;
}

void ProgressBar::report(std::string_view stage, double fraction) {
  throw_if_interrupted();
  const double shown = fraction >= 0 ? std::min(fraction, 1.0) : 0.0;
  if (!due(stage, shown)) return;
  drawn_stage_ = stage;
  drawn_fraction_ = shown;
  since_drawn_.lap();
  if (style_ == ProgressStyle::kBar) {
    out_ << kClearLine << progress_bar_text(stage, shown, since_start_.seconds()) << std::flush;
    bar_visible_ = true;
  } else {
    out_ << "mdprep: " << progress_line_text(stage, shown, since_start_.seconds()) << "\n"
         << std::flush;
  }
}

void ProgressBar::clear() {
  if (!bar_visible_) return;
  out_ << kClearLine << std::flush;
  bar_visible_ = false;
}

}  // namespace mdk
