// CostSurvey: fills the cost curves while nobody does anything. One small picture at a time goes to
// the worker, only when it has nothing else to do: a user who acts waits for one of them at most.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "viewer/picture/render_worker.h"
#include "viewer/state/cost_curves.h"

namespace mdk {

class CostSurvey {
 public:
  /// Seconds without an event until measuring goes on.
  static constexpr double kRestSeconds = 0.4;

  /// What to trace next for the curve of the technique of `picture`, as seen in it, where anything
  /// is missing. Another view, clip or file begins all `curves` anew. `key_times`: of the
  /// clip, in seconds.
  std::optional<RenderJob> next(const RenderJob& picture, std::uint32_t clip,
                                const std::vector<double>& key_times, CostCurves& curves);

  /// Enters a finished job of next(), if it is still of the present view.
  void take(const FinishedFrame& frame, CostCurves& curves) const;

 private:
  std::optional<RenderJob> view_;  ///< the curves are of this, at any time, by any technique
  std::uint32_t clip_ = 0;
};

}  // namespace mdk
