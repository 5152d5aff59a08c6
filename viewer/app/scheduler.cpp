#include "viewer/app/scheduler.h"

#include <algorithm>

namespace mdk {
namespace {

constexpr double kCurveSeconds = 0.2;  // between drawings of a growing curve

}  // namespace

void Scheduler::note_activity(double now) {
  last_activity_ = now;
  has_to_survey_ = true;
}

void Scheduler::start_again() {
  full_picture_ms_ = 0;
  has_to_survey_ = true;
}

RenderJob Scheduler::current_job(const PictureSpace& space) const {
  return job(space, picture_divisor(state_.settings.resolution, motion_, full_picture_ms_));
}

RenderJob Scheduler::job(const PictureSpace& space, std::uint32_t divisor) const {
  const std::uint32_t pictures = state_.compare.mode == CompareMode::kSideBySide ? 2 : 1;
  return picture_job(state_, std::max(1u, space.width / pictures / divisor),
                     std::max(1u, space.height / divisor));
}

bool Scheduler::request_picture(const PictureSpace& space, double now, Repeat repeat) {
  if (!state_.file) return false;
  const bool repeats =
      repeat == Repeat::kAsChosen && (state_.settings.keep_tracing || mode_ == RunMode::kScripted);
  auto next = requests_.next(current_job(space),
                             {now, worker_.busy(), state_.settings.count_work, repeats});
  if (next) worker_.request(std::move(*next));
  return next.has_value();
}

std::optional<FinishedFrame> Scheduler::take_finished(const PictureSpace& space, double now) {
  auto frame = worker_.take_finished();
  if (!frame || frame->job.file != state_.file) return {};
  if (!frame->error.empty()) {
    requests_.note_failure();
    return frame;
  }
  if (frame->job.survey) {
    survey_.take(*frame, state_.cost_curves);
    return {};
  }
  if (note_costs(*frame, state_)) {
    const FrameRequest& request = frame->job.request;
    const double ms = frame->stats.time_to_image_ms() +
                      (frame->second ? frame->second->stats.time_to_image_ms() : 0);
    full_picture_ms_ = ms * (static_cast<double>(space.width) * space.height) /
                       (static_cast<double>(request.width) * request.height);
    shown_times_.push_back(now);
  }
  return frame;
}

bool Scheduler::update_rate(double now) {
  while (!shown_times_.empty() && shown_times_.front() < now - 1) shown_times_.pop_front();
  const auto before =
      std::exchange(state_.shown_per_second, static_cast<double>(shown_times_.size()));
  return shown_times_.empty() && before != 0;
}

bool Scheduler::survey(const PictureSpace& space, double now) {
  const bool at_rest = state_.file && !state_.moves() && motion_ == Motion::kStill &&
                       !state_.hand.active && !worker_.busy() &&
                       now >= last_activity_ + CostSurvey::kRestSeconds;
  if (!at_rest || mode_ == RunMode::kScripted || failed() || state_.settings.keep_tracing)
    return false;
  const Playback& playback = state_.playback;
  const std::uint32_t divisor =
      picture_divisor(Resolution::kAuto, Motion::kDragging, full_picture_ms_);
  auto next = survey_.next(job(space, divisor), static_cast<std::uint32_t>(playback.clip()),
                           playback.clips()[playback.clip()].key_times, state_.cost_curves);
  has_to_survey_ = next.has_value();
  if (next) worker_.request(std::move(*next));
  // The curve is seen to grow, but drawing takes no time from measuring.
  const std::size_t known = state_.cost_curves.known(state_.settings.technique);
  if (known == known_drawn_ || (has_to_survey_ && now < curve_drawn_ + kCurveSeconds)) return false;
  known_drawn_ = known;
  curve_drawn_ = now;
  return true;
}

}  // namespace mdk
