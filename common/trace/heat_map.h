// Heat maps: amounts as colours, from violet over green to yellow: lighter is more, also in grey.
// What they show is counted work, or residuals: the motion that a cluster's map does not explain.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "common/math/vec3.h"
#include "common/motion/posed_mesh.h"
#include "common/trace/frame_stats.h"

namespace mdk {

/// What the lightest colour of a picture stands for; the darkest one stands for 0.
struct HeatScale {
  double top = 0;         ///< 0: the picture is no heat map
  std::string_view unit;  ///< as in "visits per ray"

  bool operator==(const HeatScale&) const = default;
};

/// The colour (linear RGB) of a share of the scale; clamped to [0, 1], and dark where it is not a
/// number.
Vec3f heat_color(double share);

/// The smallest of 1, 2, 5, 10, ... times a power of ten that is not below `value`; 1 where the
/// value is not above 0.
double round_scale(double value);

/// Per triangle, the largest residual of its corners in the current pose, relative to the rest
/// pose's diagonal (GFW06 §3.1): the distance, in the cluster's basis, of the corner from where it
/// is in the rest pose. `out` has one per triangle. Decodes the rest pose. Runs in parallel. Cost:
/// O(vertices + triangles).
void triangle_residuals(const PosedMesh& mesh, std::span<float> out);

/// What one sample's heat map shows, by triangle or by tile. Keeps its memory between frames.
class HeatMap {
 public:
  HeatMap();

  /// Residuals of the current pose (triangle_residuals()), in percent, as indices of palette().
  HeatScale color_triangles(const PosedMesh& mesh);
  const std::vector<Vec3f>& palette() const { return palette_; }
  const std::vector<std::uint32_t>& triangle_colors() const { return triangle_colors_; }

  /// One count of each tile, per ray.
  HeatScale color_tiles(std::span<const TraceCounters> tiles, std::uint64_t TraceCounters::*count,
                        std::string_view unit);
  const Vec3f& tile_color(std::size_t tile) const { return tile_colors_[tile]; }

 private:
  std::vector<Vec3f> palette_;  ///< from 0 to the top of the scale
  std::vector<float> residuals_;
  std::vector<std::uint32_t> triangle_colors_;
  std::vector<Vec3f> tile_colors_;
};

}  // namespace mdk
