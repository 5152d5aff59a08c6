// SceneRenderer: pictures of a scene, a frame at a time: update, trace, shade, each timed. Nothing
// is copied for an instance; what rays need of one is worked out when they enter it, in pools of
// fixed size (docs/crowds.md).
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "common/scene/scene.h"
#include "common/trace/camera.h"
#include "common/trace/frame_stats.h"
#include "common/trace/hit_buffer.h"
#include "common/trace/kernels/crowd_kernels.h"
#include "common/trace/scene_shading.h"

namespace mdk {

struct SceneRequest {
  double time = 0;  ///< of the scene, seconds
  Camera camera;
  std::uint32_t width = 512, height = 512;  ///< 1 to kMaxImageSide each
  ShadingMode shading = ShadingMode::kDiffuse;
  std::uint32_t samples = 1;             ///< per pixel, 1 to kMaxSamples
  std::span<const double> shutter = {};  ///< the time of each sample; empty: all at `time`
  bool counting = false;                 ///< counts cost time
};

struct SceneStats {
  double update_ms = 0;  ///< making the hierarchy over instances valid
  double trace_ms = 0;
  double shade_ms = 0;
  double prebuild_ms = 0;  ///< once: hierarchies of the models and over the instances
  std::uint64_t rays = 0, hits = 0;
  std::uint64_t instances_posed =
      0;                   ///< whose rays were worked out; more than once by some threads
  CrowdCounters counters;  ///< all zero unless counting was asked for

  double time_to_image_ms() const { return update_ms + trace_ms + shade_ms; }
};

/// The closest hit of every pixel, and the instance it is of.
struct SceneHits {
  HitBuffer hits;
  std::vector<TileInstances> instances;  ///< one per tile; of no meaning where none is hit

  /// kNoHit where nothing is hit.
  std::uint32_t instance(std::uint32_t x, std::uint32_t y) const;
};

/// Pixels of two pictures of one size whose instance, triangle or depth differ, to the bit.
std::uint64_t count_mismatches(const SceneHits& a, const SceneHits& b);

enum class SceneTechnique {
  kFuzzy,       ///< fuzzy-bvh: one structure for all instances of a model, whatever their times
  kRefit,       ///< refit-bvh: a hierarchy for each instance, refitted in every frame
  kBruteForce,  ///< brute-force: every triangle of every instance
};

struct SceneOptions {
  SceneTechnique technique = SceneTechnique::kFuzzy;
  std::size_t cache_bytes = std::size_t{64} << 20;  ///< half for pools, half for key poses
  /// Instances of so many pixels a triangle, or fewer, go pixel by pixel. Changes no picture.
  float line_share = 0.06f;
};

/// Not for use from several threads at once; uses many inside. The stage must outlive it.
class SceneRenderer {
 public:
  explicit SceneRenderer(const Stage& stage, const SceneOptions& options = {});
  ~SceneRenderer();
  SceneRenderer(const SceneRenderer&) = delete;
  SceneRenderer& operator=(const SceneRenderer&) = delete;

  /// Update, trace and shade, for each sample; results stay valid until the next call. Throws Error
  /// (kUsage) for a size, camera or number that cannot be.
  const SceneStats& render(const SceneRequest& request);
  /// The first sample of render(), without shading.
  const SceneStats& trace(const SceneRequest& request);

  /// sRGB RGBA, width * height, row 0 on top.
  std::span<const std::uint32_t> pixels() const;
  /// Of the last sample.
  const SceneHits& hits() const;
  const SceneStats& stats() const;
  /// Beside the mapped files: hierarchies of the models and over instances.
  std::size_t structure_bytes() const;
  /// Pools, and what was worked out of keys.
  std::size_t cache_bytes() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace mdk
