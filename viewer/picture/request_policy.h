// RequestPolicy: which picture to ask the worker for next, if any.
#pragma once

#include <optional>

#include "viewer/picture/render_worker.h"

namespace mdk {

/// Asks for a picture when the wanted one is not the one asked for last, and for nothing while
/// nothing changes. Counting frames go between: now and then while pictures change, and once when
/// they have come to rest; a picture that was only counted is timed as well.
class RequestPolicy {
 public:
  static constexpr double kCountSeconds = 0.5;  ///< at least, between counting frames

  struct Situation {
    double now = 0;  ///< seconds, rising
    bool worker_busy = false;
    bool count_work = false;    ///< counts are wanted
    bool keep_tracing = false;  ///< the same picture is wanted again and again
  };

  std::optional<RenderJob> next(const RenderJob& wanted, const Situation& situation);

  /// The last job could not be done: it is not repeated unchanged.
  void note_failure() { failed_ = true; }
  bool failed() const { return failed_; }

 private:
  std::optional<RenderJob> requested_, counted_, timed_;
  double last_count_ = -kCountSeconds;
  bool failed_ = false;
};

}  // namespace mdk
