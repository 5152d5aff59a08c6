// Renderer: one model, one technique, one frame at a time: pose, update, trace, shade, each timed.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
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
  Counting counting = Counting::kOff;  ///< counts cost time: never time a counting frame
  const SkeletonPose* pose = nullptr;  ///< where there is one, it counts instead of `at`
};

/// Not for use from several threads at once; uses many inside. The model must outlive it.
class Renderer {
 public:
  Renderer(const Model& model, std::string_view technique_id);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  /// Changes the technique; the next frame uses it. Structures already built by others are kept, so
  /// switching back is free. Throws Error (kUsage) for an unknown id.
  void set_technique(std::string_view id);
  std::string_view technique_id() const;

  /// Pose, update, trace and shade; results stay valid until the next call. Throws Error (kUsage)
  /// for a size or camera that cannot be.
  const FrameStats& render(const FrameRequest& request);

  /// As render(), without shading.
  const FrameStats& trace(const FrameRequest& request);

  /// sRGB RGBA, width * height, row 0 on top.
  std::span<const std::uint32_t> pixels() const;
  const HitBuffer& hits() const;
  const FrameStats& stats() const;
  std::size_t structure_bytes() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace mdk
