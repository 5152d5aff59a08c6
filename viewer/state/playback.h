// Playback: which clip is shown at which moment, and how time goes on. No clock of its own: the
// caller says how much time has passed.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/motion/model.h"

namespace mdk {

enum class LoopMode {
  kOnce,      ///< stops at the end
  kLoop,      ///< from the end to the start
  kPingPong,  ///< there and back
};

enum class StepDirection { kBack, kForward };

inline constexpr double kMinSpeed = 0.05, kMaxSpeed = 8;

/// The times of one clip's keys, in seconds from its start, rising; at least one.
struct ClipTimes {
  std::string name;
  std::vector<double> key_times;

  double seconds() const { return key_times.back(); }
};

/// Part of a clip, in seconds from its start; `begin` < `end`.
struct TimeRange {
  double begin = 0, end = 0;

  bool operator==(const TimeRange&) const = default;
};

std::vector<ClipTimes> clip_times(const ModelView& model);

/// The time is always within the clip. Without clips every call is harmless and the time stays 0.
class Playback {
 public:
  Playback() = default;
  /// Stands at the start of the first clip, paused.
  explicit Playback(std::vector<ClipTimes> clips) : clips_(std::move(clips)) {}

  /// Other clips: goes on in the one of the same name at the same time, as far as there is one.
  void set_clips(std::vector<ClipTimes> clips);

  const std::vector<ClipTimes>& clips() const { return clips_; }
  std::size_t clip() const { return clip_; }
  double time() const { return time_; }
  double seconds() const { return clips_.empty() ? 0 : clips_[clip_].seconds(); }
  bool playing() const { return playing_; }
  LoopMode loop() const { return loop_; }
  double speed() const { return speed_; }
  /// The last key at or before the current time, counted within the clip.
  std::size_t key() const;

  /// Playing stays inside the range, where there is one.
  const std::optional<TimeRange>& range() const { return range_; }
  /// Ends in either order, clamped to the clip; one without length clears the range, one with an
  /// end that is not a number is ignored.
  void set_range(double from, double to);
  void clear_range() { range_.reset(); }
  /// Moves one end of the range to the current time; the other stays, or is the clip's. An end that
  /// would pass the other begins a new range up to the clip's end, or from its start.
  void begin_range_here();
  void end_range_here();
  /// The range, or all of the clip.
  TimeRange played() const { return range_.value_or(TimeRange{0, seconds()}); }
  /// The time of the key nearest to `time`.
  double nearest_key_time(double time) const;

  /// Goes to the start of another clip and plays on if it was playing and there is more than one
  /// key. A number that is no clip is ignored.
  void set_clip(std::size_t clip);
  /// Whether there was a clip of this name to go to.
  bool set_clip(std::string_view name);

  /// To a moment, clamped to the clip; what is not a number is ignored.
  void seek(double time);
  /// Pauses at the next key before or behind the current time; loops wrap around.
  void step_key(StepDirection direction);
  void go_to_start() { seek(played().begin); }
  void go_to_end() { seek(played().end); }

  /// At the end of what does not loop, or outside of the range, playing starts over.
  void play();
  void pause() { playing_ = false; }
  void toggle() { playing_ ? pause() : play(); }

  void set_loop(LoopMode loop);
  void set_speed(double speed);

  /// While the user drags the play head, time stands where it is dragged; playing goes on
  /// afterwards.
  void begin_scrub() { scrubbing_ = true; }
  void end_scrub() { scrubbing_ = false; }
  bool scrubbing() const { return scrubbing_; }

  /// Lets `elapsed` seconds of wall-clock time pass. Whether the time shown has changed.
  bool advance(double elapsed);

 private:
  void advance_ping_pong(double step);

  std::vector<ClipTimes> clips_;
  std::size_t clip_ = 0;
  double time_ = 0, speed_ = 1;
  std::optional<TimeRange> range_;
  LoopMode loop_ = LoopMode::kLoop;
  StepDirection direction_ = StepDirection::kForward;  ///< of ping-pong
  bool playing_ = false, scrubbing_ = false;
};

}  // namespace mdk
