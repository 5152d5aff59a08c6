#include "viewer/picture/request_policy.h"

namespace mdk {

std::optional<RenderJob> RequestPolicy::next(const RenderJob& wanted, const Situation& situation) {
  const bool changed = !requested_ || !same_picture(*requested_, wanted);
  if (!changed && (failed_ || situation.worker_busy)) return {};

  const bool uncounted = !counted_ || !same_picture(*counted_, wanted);
  const bool counts = situation.count_work && uncounted &&
                      (!changed || situation.now - last_count_ >= kCountSeconds);
  const bool untimed = !timed_ || !same_picture(*timed_, wanted);
  if (!changed && !counts && !untimed && !situation.keep_tracing) return {};

  RenderJob job = wanted;
  if (counts) {
    job.request.counting = Counting::kOn;
    counted_ = job;
    last_count_ = situation.now;
  } else {
    timed_ = job;
  }
  failed_ = false;
  requested_ = job;
  return job;
}

}  // namespace mdk
