#include "viewer/picture/cost_survey.h"

#include <utility>

#include "common/motion/model.h"

namespace mdk {
namespace {

// A job of the view: neither technique nor moment belong to it.
RenderJob view_of(RenderJob job) {
  job.technique = 0;
  job.against.reset();
  job.request.at = {};
  job.survey.reset();
  return job;
}

}  // namespace

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
