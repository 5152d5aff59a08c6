// Shading of scenes: from hits to light, tile by tile. What a model's pictures show, mapped into
// the world and tinted by instance.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "common/trace/film.h"
#include "common/trace/instance_pool.h"
#include "common/trace/shading.h"

namespace mdk {

/// Modes that scenes have: those that need neither beams of light nor the counts of tiles.
bool is_scene_shading(ShadingMode mode);

class SceneShader {
 public:
  /// The models must outlive it.
  SceneShader(const Stage& stage, std::span<const std::unique_ptr<CrowdModel>> models);

  /// Puts a tile that is hit on the film. `pool` knows the frame's instances. Between two keys a
  /// smooth normal is interpolated from those at the keys. Many threads may shade at once.
  void shade_tile(const CrowdFrame& frame, ShadingMode mode, std::uint32_t left, std::uint32_t top,
                  const TileHits& hits, const TileInstances& instances, InstancePool& pool,
                  Film& film) const;

 private:
  struct ModelColors {
    std::vector<std::uint32_t> triangle_cluster;
  };
  const Stage& stage_;
  std::span<const std::unique_ptr<CrowdModel>> models_;
  std::vector<ModelColors> colors_;
};

}  // namespace mdk
