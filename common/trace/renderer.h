// Renderer: one model, one technique, one frame at a time: pose, update, trace, shade, each timed;
// and the moments at which the samples of a frame are taken, for motion blur.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/motion/posed_mesh.h"
#include "common/trace/camera.h"
#include "common/trace/frame_stats.h"
#include "common/trace/hit_buffer.h"
#include "common/trace/shading.h"
#include "common/trace/technique.h"

namespace mdk {

enum class Counting { kOff, kOn };

struct FrameRequest {
  KeyInterval at;
  Camera camera;
  std::uint32_t width = 512, height = 512;  ///< 1 to kMaxImageSide each
  ShadingMode shading = ShadingMode::kDiffuse;
  std::uint32_t samples = 1;  ///< per pixel, 1 to kMaxSamples; 1: through the pixel's centre
  std::uint32_t occlusion_rays = kOcclusionRays;  ///< per sample of kLit, 0 to kMaxOcclusionRays
  std::span<const KeyInterval> shutter = {};      ///< the moment of each sample; empty: all at `at`
  Counting counting = Counting::kOff;             ///< counts cost time: never time a counting frame
  const SkeletonPose* pose = nullptr;             ///< where there is one, it counts instead of `at`
};

/// Not for use from several threads at once; uses many inside. The model must outlive it.
class Renderer {
 public:
  Renderer(const ModelView& model, std::string_view technique_id);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  /// Changes the technique; the next frame uses it. Structures already built by others are kept, so
  /// switching back is free. Throws Error (kUsage) for an unknown id.
  void set_technique(std::string_view id);
  std::string_view technique_id() const;

  /// Pose, update, trace and shade, for each sample; results stay valid until the next call. Throws
  /// Error (kUsage) for a size, camera or number that cannot be.
  const FrameStats& render(const FrameRequest& request);

  /// The first sample of render(), without shading.
  const FrameStats& trace(const FrameRequest& request);

  /// sRGB RGBA, width * height, row 0 on top.
  std::span<const std::uint32_t> pixels() const;
  /// Of the last sample.
  const HitBuffer& hits() const;
  /// What the colours of a heat map mean, for the last sample.
  const HeatScale& heat_scale() const;
  /// What each tile of hits() cost, where the shading shows it.
  std::span<const TraceCounters> tile_work() const;
  const FrameStats& stats() const;
  std::size_t structure_bytes() const;
  /// Technique::note() of the current technique.
  std::string technique_note() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// One moment per sample, spread evenly over `open` seconds with `seconds` of the clip in their
/// middle, which is the first one's; in an order that has nothing to do with where in their pixel
/// the samples are. Times outside the clip are clamped to it.
std::vector<KeyInterval> shutter_moments(const ModelView& model, std::uint32_t clip, double seconds,
                                         double open, std::uint32_t samples);

}  // namespace mdk
