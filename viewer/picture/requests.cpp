#include "viewer/picture/requests.h"

#include <utility>

#include "common/motion/model.h"
#include "common/trace/technique.h"

namespace mdk {
namespace {

/// Its boxes are of the current pose alone, whichever that is.
constexpr const char* kUnlimitedTechnique = "refit-bvh";

constexpr double kFluentMs = 40;  // 25 pictures a second still follow the hand

// A job of the view: neither technique nor moment belong to it.
RenderJob view_of(RenderJob job) {
  job.technique = 0;
  job.against.reset();
  job.request.at = {};
  job.survey.reset();
  return job;
}

}  // namespace

RenderJob picture_job(const ViewState& state, std::uint32_t width, std::uint32_t height) {
  const ModelView& model = *state.model();
  RenderJob job;
  job.file = state.file;
  job.technique = state.settings.technique;
  job.part = state.clusters.part();
  if (state.compare.mode != CompareMode::kOff) job.against = state.compare.against;
  if (state.hand.active) {
    job.pose = state.hand.pose;
    if (joint_past_limit(model.skeleton, *job.pose) != kNoParent) {
      job.technique = technique_row(kUnlimitedTechnique);
      if (job.against) job.against = job.technique;
    }
  }
  const Playback& playback = state.playback;
  job.request.at = locate_time(model, static_cast<std::uint32_t>(playback.clip()), playback.time());
  job.request.camera = state.camera.camera();
  job.request.width = width;
  job.request.height = height;
  job.request.shading = state.settings.shading;
  job.request.samples = state.settings.samples;
  job.request.occlusion_rays = state.settings.occlusion_rays;
  return job;
}

bool note_costs(const FinishedFrame& frame, ViewState& state) {
  const RenderJob& job = frame.job;
  if (job.request.counting == Counting::kOn) {
    if (frame.second)
      state.frames.add_work({*job.against, frame.second->stats.rays, frame.second->stats.counters});
    state.frames.add_work({job.technique, frame.stats.rays, frame.stats.counters});
    return false;
  }
  state.frames.add(frame);
  if (frame.second) state.frames.add_second(*frame.second, frame.difference);
  return true;
}

std::uint32_t picture_divisor(Resolution resolution, Motion motion, double full_ms) {
  switch (resolution) {
    case Resolution::kFull:
      return 1;
    case Resolution::kHalf:
      return 2;
    case Resolution::kQuarter:
      return 4;
    case Resolution::kAuto:
      break;
  }
  if (motion == Motion::kStill || full_ms <= kFluentMs) return 1;
  return full_ms <= 4 * kFluentMs ? 2 : 4;
}

std::optional<RenderJob> RequestPolicy::next(const RenderJob& picture, const Situation& situation) {
  const bool changed = !requested_ || !same_picture(*requested_, picture);
  if (!changed && (failed_ || situation.worker_busy)) return {};

  const bool uncounted = !counted_ || !same_picture(*counted_, picture);
  const bool counts = situation.count_work && uncounted &&
                      (!changed || situation.now - last_count_ >= kCountSeconds);
  const bool untimed = !timed_ || !same_picture(*timed_, picture);
  if (!changed && !counts && !untimed && !situation.keep_tracing) return {};

  RenderJob job = picture;
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

std::optional<RenderJob> CostSurvey::next(const RenderJob& picture, std::uint32_t clip,
                                          const std::vector<double>& key_times,
                                          CostCurves& curves) {
  RenderJob view = view_of(picture);
  if (!view_ || !same_picture(*view_, view) || clip != clip_) {
    view_ = std::move(view);
    clip_ = clip;
    curves.start(key_times);
  }
  const auto moment = curves.next_moment(picture.technique);
  if (!moment) return {};
  RenderJob job = picture;
  job.against.reset();
  job.request.at = locate_time(job.file->model(), clip, curves.moments()[*moment]);
  job.survey = SurveyMark{clip, *moment};
  return job;
}

void CostSurvey::take(const FinishedFrame& frame, CostCurves& curves) const {
  const SurveyMark& mark = *frame.job.survey;
  if (!view_ || mark.clip != clip_ || !same_picture(*view_, view_of(frame.job))) return;
  curves.add(frame.job.technique, mark.moment, frame.stats.time_to_image_ms());
}

}  // namespace mdk
