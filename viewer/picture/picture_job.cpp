#include "viewer/picture/picture_job.h"

#include "common/trace/technique.h"

namespace mdk {
namespace {

/// Its boxes are of the present pose alone, whichever that is.
constexpr const char* kBoundlessTechnique = "refit-bvh";

FrameReport report_of(const TracedFrame& frame, const RenderJob& job, std::size_t technique) {
  const FrameRequest& request = job.request;
  return {technique,  request.width, request.height, frame.stats,           frame.structure_bytes,
          frame.note, frame.heat,    request.camera, {request.at, job.pose}};
}

}  // namespace

std::size_t technique_row(std::string_view id) {
  return static_cast<std::size_t>(&find_technique(id) - technique_table().data());
}

RenderJob picture_job(const ViewState& state, std::uint32_t width, std::uint32_t height) {
  const Model& model = *state.model();
  RenderJob job;
  job.file = state.file;
  job.technique = state.settings.technique;
  job.part = state.clusters.part();
  if (state.compare.mode != CompareMode::kOff) job.against = state.compare.against;
  if (state.hand.active) {
    job.pose = state.hand.pose;
    if (joint_past_limit(model.skeleton, *job.pose) != kNoParent) {
      job.technique = technique_row(kBoundlessTechnique);
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
      state.note_work({*job.against, frame.second->stats.rays, frame.second->stats.counters});
    state.note_work({job.technique, frame.stats.rays, frame.stats.counters});
    return false;
  }
  state.note_frame(report_of(frame, job, job.technique));
  if (frame.second)
    state.note_second_frame(report_of(*frame.second, job, *job.against), frame.difference);
  return true;
}

}  // namespace mdk
