#include "viewer/picture/picture_job.h"

#include "common/trace/technique.h"

namespace mdk {
namespace {

/// Its boxes are of the present pose alone, whichever that is.
constexpr const char* kBoundlessTechnique = "refit-bvh";

}  // namespace

std::size_t technique_row(std::string_view id) {
  return static_cast<std::size_t>(&find_technique(id) - technique_table().data());
}

RenderJob picture_job(const ViewState& state, std::uint32_t width, std::uint32_t height) {
  const Model& model = *state.model();
  RenderJob job;
  job.file = state.file;
  job.technique = state.settings.technique;
  if (state.hand.active) {
    job.pose = state.hand.pose;
    if (joint_past_limit(model.skeleton, *job.pose) != kNoParent)
      job.technique = technique_row(kBoundlessTechnique);
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

}  // namespace mdk
