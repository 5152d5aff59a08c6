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

  /// `pixels`: width * height of the hit buffer. Runs in parallel.
  void shade(const PosedMesh& mesh, const PinholeRays& rays, const HitBuffer& hits,
             ShadingMode mode, std::span<std::uint32_t> pixels);

 private:
  void compute_vertex_normals(const PosedMesh& mesh);
  Vec3f shade_hit(const PosedMesh& mesh, const PinholeRays& rays, const Vec3f& direction,
                  std::uint32_t triangle, ShadingMode mode) const;
  Vec3f shading_normal(std::uint32_t triangle, const Vec3f& face_normal,
                       const float (&bary)[3]) const;
  Vec3f base_color(std::uint32_t triangle, const float (&bary)[3]) const;

  const Model* model_;
  std::vector<std::uint32_t> triangle_cluster_;
  std::vector<std::uint32_t> first_corner_;  ///< per vertex, CSR: its triangles in ring_
  std::vector<std::uint32_t> ring_;
  std::vector<Vec3f> vertex_normals_;
};

}  // namespace mdk
