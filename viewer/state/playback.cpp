#include "viewer/state/playback.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace mdk {

std::vector<ClipTimes> clip_times(const ModelView& model) {
  std::vector<ClipTimes> clips;
  for (const Clip& clip : model.clips) {
    const auto times = model.key_times.subspan(clip.first_key, clip.key_count);
    clips.push_back({clip.name, {times.begin(), times.end()}});
  }
  return clips;
}

void Playback::set_clips(std::vector<ClipTimes> clips) {
  const std::string name = clips_.empty() ? std::string() : clips_[clip_].name;
  const double time = time_;
  const std::optional<TimeRange> range = range_;
  clips_ = std::move(clips);
  clip_ = 0;
  range_.reset();
  if (set_clip(name) && range) set_range(range->begin, range->end);
  seek(time);
}

std::size_t Playback::key() const {
  if (clips_.empty()) return 0;
  const auto& times = clips_[clip_].key_times;
  const auto after = std::upper_bound(times.begin(), times.end(), time_);
  return after == times.begin() ? 0 : static_cast<std::size_t>(after - times.begin()) - 1;
}

void Playback::set_clip(std::size_t clip) {
  if (clip >= clips_.size()) return;
  clip_ = clip;
  time_ = 0;
  range_.reset();
  direction_ = StepDirection::kForward;
  if (!(seconds() > 0)) pause();
}

bool Playback::set_clip(std::string_view name) {
  for (std::size_t i = 0; i < clips_.size(); ++i)
    if (clips_[i].name == name) {
      set_clip(i);
      return true;
    }
  return false;
}

void Playback::set_range(double from, double to) {
  if (std::isnan(from) || std::isnan(to)) return;
  const double a = std::clamp(from, 0.0, seconds()), b = std::clamp(to, 0.0, seconds());
  range_.reset();
  if (a != b) range_ = TimeRange{std::min(a, b), std::max(a, b)};
  direction_ = StepDirection::kForward;
}

void Playback::begin_range_here() {
  const double end = played().end;
  set_range(time_, time_ < end ? end : seconds());
}

void Playback::end_range_here() {
  const double begin = played().begin;
  set_range(time_ > begin ? begin : 0, time_);
}

double Playback::nearest_key_time(double time) const {
  if (clips_.empty() || std::isnan(time)) return 0;
  const auto& times = clips_[clip_].key_times;
  const auto after = std::lower_bound(times.begin(), times.end(), time);
  if (after == times.begin()) return times.front();
  if (after == times.end()) return times.back();
  return time - *(after - 1) < *after - time ? *(after - 1) : *after;
}

void Playback::seek(double time) {
  if (std::isnan(time)) return;
  time_ = std::clamp(time, 0.0, seconds());
}

void Playback::step_key(StepDirection direction) {
  pause();
  if (clips_.empty()) return;
  const auto& times = clips_[clip_].key_times;
  const bool wraps = loop_ != LoopMode::kOnce;
  if (direction == StepDirection::kForward) {
    const auto next = std::upper_bound(times.begin(), times.end(), time_);
    if (next != times.end())
      time_ = *next;
    else if (wraps)
      time_ = 0;
  } else {
    const auto here = std::lower_bound(times.begin(), times.end(), time_);
    if (here != times.begin())
      time_ = *(here - 1);
    else if (wraps)
      time_ = seconds();
  }
}

void Playback::play() {
  if (!(seconds() > 0)) return;  // one key: there is nothing to play
  const TimeRange span = played();
  const bool outside = range_ && (time_ < span.begin || time_ > span.end);
  if (outside || (loop_ == LoopMode::kOnce && time_ >= span.end)) time_ = span.begin;
  playing_ = true;
}

void Playback::set_loop(LoopMode loop) {
  loop_ = loop;
  direction_ = StepDirection::kForward;
}

void Playback::set_speed(double speed) {
  if (!std::isnan(speed)) speed_ = std::clamp(speed, kMinSpeed, kMaxSpeed);
}

bool Playback::advance(double elapsed) {
  if (!playing_ || scrubbing_ || !(elapsed > 0) || !std::isfinite(elapsed)) return false;
  const double before = time_, step = elapsed * speed_;
  const TimeRange span = played();
  if (!(span.begin < span.end)) {  // one key: there is nothing to play
    pause();
    return false;
  }
  switch (loop_) {
    case LoopMode::kOnce:
      seek(std::min(time_ + step, span.end));
      if (time_ >= span.end) pause();
      break;
    case LoopMode::kLoop:
      time_ += step;
      if (time_ > span.end)
        time_ = span.begin + std::fmod(time_ - span.begin, span.end - span.begin);
      break;
    case LoopMode::kPingPong:
      advance_ping_pong(step);
      break;
  }
  return time_ != before;
}

// Unrolled, there and back is one loop of twice the length.
void Playback::advance_ping_pong(double step) {
  const TimeRange span = played();
  const double length = span.end - span.begin;
  const double at = std::clamp(time_ - span.begin, 0.0, length);
  const double phase = direction_ == StepDirection::kForward ? at : 2 * length - at;
  const double moved = std::fmod(phase + step, 2 * length);
  direction_ = moved < length ? StepDirection::kForward : StepDirection::kBack;
  time_ = span.begin + std::clamp(moved < length ? moved : 2 * length - moved, 0.0, length);
}

}  // namespace mdk
