#include "viewer/state/playback.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace mdk {

std::vector<ClipTimes> clip_times(const Model& model) {
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
  clips_ = std::move(clips);
  clip_ = 0;
  set_clip(name);
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
  direction_ = StepDirection::kForward;
}

bool Playback::set_clip(std::string_view name) {
  for (std::size_t i = 0; i < clips_.size(); ++i)
    if (clips_[i].name == name) {
      set_clip(i);
      return true;
    }
  return false;
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
  if (loop_ == LoopMode::kOnce && time_ >= seconds()) time_ = 0;
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
  switch (loop_) {
    case LoopMode::kOnce:
      seek(time_ + step);
      if (time_ >= seconds()) pause();
      break;
    case LoopMode::kLoop:
      time_ += step;
      if (time_ > seconds()) time_ = std::fmod(time_, seconds());
      break;
    case LoopMode::kPingPong:
      advance_ping_pong(step);
      break;
  }
  return time_ != before;
}

// Unrolled, there and back is one loop of twice the length.
void Playback::advance_ping_pong(double step) {
  const double length = seconds();
  const double phase = direction_ == StepDirection::kForward ? time_ : 2 * length - time_;
  const double moved = std::fmod(phase + step, 2 * length);
  direction_ = moved < length ? StepDirection::kForward : StepDirection::kBack;
  time_ = std::clamp(moved < length ? moved : 2 * length - moved, 0.0, length);
}

}  // namespace mdk
