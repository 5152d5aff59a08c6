// Requests: what the worker is asked for next: the picture of what the user looks at, a frame that
// counts its work, or a measurement while the user rests.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "viewer/picture/render_worker.h"
#include "viewer/state/view_state.h"

namespace mdk {

/// The picture of an open file. A pose in which the boxes of all times do not hold is traced by a
/// technique that needs none.
RenderJob picture_job(const ViewState& state, std::uint32_t width, std::uint32_t height);

/// Notes in the state what a frame without error cost; true where it was timed, not counted.
bool note_costs(const FinishedFrame& frame, ViewState& state);

/// Whether the user drags something.
enum class Motion { kStill, kDragging };

/// Window pixels per traced pixel along each side: 1, 2 or 4. `full_ms` is what a picture at full
/// resolution is expected to take; only kAuto depends on it.
std::uint32_t picture_divisor(Resolution resolution, Motion motion, double full_ms);

/// Asks for a picture when it is not the one asked for last, and for nothing while
/// nothing changes. Counting frames go between: now and then while pictures change, and once when
/// they have come to rest; a picture that was only counted is timed as well.
class RequestPolicy {
 public:
  static constexpr double kCountSeconds = 0.5;  ///< at least, between counting frames

  struct Situation {
    double now = 0;  ///< seconds, rising
    bool worker_busy = false;
    bool count_work = false;    ///< counting frames are due
    bool keep_tracing = false;  ///< the same picture is traced again and again
  };

  std::optional<RenderJob> next(const RenderJob& picture, const Situation& situation);

  /// The last job could not be done: it is not repeated unchanged.
  void note_failure() { failed_ = true; }
  bool failed() const { return failed_; }

 private:
  std::optional<RenderJob> requested_, counted_, timed_;
  double last_count_ = -kCountSeconds;
  bool failed_ = false;
};

/// Fills the cost curves while nobody does anything. One small picture at a time goes to
/// the worker, only when it has nothing else to do: a user who acts waits for one of them at most.
class CostSurvey {
 public:
  /// Seconds without an event until measuring goes on.
  static constexpr double kRestSeconds = 0.4;

  /// What to trace next for the curve of the technique of `picture`, as seen in it, where anything
  /// is missing. Another view, clip or file starts all `curves` again. `key_times`: of the
  /// clip, in seconds.
  std::optional<RenderJob> next(const RenderJob& picture, std::uint32_t clip,
                                const std::vector<double>& key_times, CostCurves& curves);

  /// Enters a finished job of next(), if it is still of the current view.
  void take(const FinishedFrame& frame, CostCurves& curves) const;

 private:
  std::optional<RenderJob> view_;  ///< the curves are of this, at any time, by any technique
  std::uint32_t clip_ = 0;
};

}  // namespace mdk
