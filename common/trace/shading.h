// Shading: from hits to pixels. The same for every technique, so that pictures differ only if hits
// do.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "common/motion/posed_mesh.h"
#include "common/trace/camera.h"
#include "common/trace/hit_buffer.h"
#include "common/trace/kernels/surface_kernel.h"
#include "common/trace/vertex_normals.h"

namespace mdk {

enum class ShadingMode {
  kDiffuse,   ///< headlight on the base colour, the papers' shader
  kNormals,   ///< the shading normal as a colour
  kClusters,  ///< headlight on one colour per cluster
};

struct ShadingInfo {
  ShadingMode mode;
  std::string_view id;     ///< as on the command line
  std::string_view label;  ///< as in the panel
};

std::span<const ShadingInfo> shading_table();

/// The mode with this id; throws Error (kUsage) with the ids there are.
ShadingMode find_shading(std::string_view id);

/// A colour for a cluster (linear RGB): neighbours in number are far apart in hue.
Vec3f cluster_color(std::uint32_t cluster);

/// Turns hits into sRGB RGBA pixels (red lowest, row 0 on top). Keeps what it needs between frames.
class Shader {
 public:
  explicit Shader(const Model& model);

  /// `pixels`: width * height of the hit buffer. Runs in parallel. The same pixels for any number
  /// of threads and any instruction set.
  void shade(const PosedMesh& mesh, const PinholeRays& rays, const HitBuffer& hits,
             ShadingMode mode, std::span<std::uint32_t> pixels);

 private:
  struct Tile;

  ShadedMesh shaded_mesh(const PosedMesh& mesh, ShadingMode mode) const;
  void light_tile(ShadingMode mode, Tile& tile) const;
  void apply_textures(Tile& tile) const;
  void write_pixels(const Tile& tile, std::span<std::uint32_t> pixels) const;

  const Model* model_;
  std::vector<Vec3f> material_colors_, cluster_colors_;
  std::vector<std::uint32_t> triangle_cluster_;
  std::vector<std::uint8_t> is_flat_;   ///< per triangle
  std::vector<std::uint8_t> is_unlit_;  ///< per material
  bool has_unlit_ = false, has_textures_ = false;
  VertexNormals vertex_normals_;
  std::vector<std::uint32_t> background_;  ///< one colour per row
};

}  // namespace mdk
