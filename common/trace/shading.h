// Shading: from hits to pixels. The same for every technique, so that pictures differ only if hits
// do.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

#include "common/motion/posed_mesh.h"
#include "common/trace/camera.h"
#include "common/trace/film.h"
#include "common/trace/heat_map.h"
#include "common/trace/hit_buffer.h"
#include "common/trace/lighting.h"

namespace mdk {

enum class ShadingMode {
  kDiffuse,   ///< headlight on the base colour, the papers' shader
  kNormals,   ///< the shading normal as a colour
  kLit,       ///< key light with shadows, ambient occlusion, base colours and textures
  kClusters,  ///< headlight on one colour per cluster
  kBoxes,     ///< heat map of node visits, tile by tile
  kTests,     ///< heat map of triangle tests, tile by tile
  kResidual,  ///< heat map of what the clusters' maps do not explain, by triangle
  kAffine,    ///< headlight on the mesh as the clusters' maps alone would have it
};

struct ShadingInfo {
  ShadingMode mode;
  std::string_view id;     ///< as on the command line
  std::string_view label;  ///< as in the panel
};

std::span<const ShadingInfo> shading_table();

/// The mode with this id; throws Error (kUsage) with the ids there are.
ShadingMode find_shading(std::string_view id);

/// The id of a mode, as on the command line.
std::string_view shading_id(ShadingMode mode);

/// A colour for a cluster (linear RGB): neighbours in number are far apart in hue.
Vec3f cluster_color(std::uint32_t cluster);

/// Whether a mode shows the counts of tiles.
constexpr bool shows_work(ShadingMode mode) {
  return mode == ShadingMode::kBoxes || mode == ShadingMode::kTests;
}

/// What a sample of the picture is made from.
struct ShadingInput {
  const PosedMesh& mesh;
  const PinholeRays& rays;
  const HitBuffer& hits;
  const Lighting* lighting = nullptr;             ///< for kLit, which needs it
  std::span<const TraceCounters> tile_work = {};  ///< one per tile, for modes that show it
};

struct ShadingReport {
  std::uint64_t rays = 0;  ///< to lights and sky
  HeatScale heat;          ///< of heat maps
};

/// Turns hits into light on a film. Keeps what it needs between frames.
class Shader {
 public:
  explicit Shader(const ModelView& model);
  ~Shader();

  /// One sample of every pixel. Runs in parallel. The same for any number of threads and any
  /// instruction set.
  ShadingReport shade(const ShadingInput& input, ShadingMode mode, Film& film);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace mdk
