// HeatMap: amounts as colours, from violet over green to yellow: lighter is more, also in grey.
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

/// The least of 1, 2, 5, 10, ... times a power of ten that is not below `value`; 1 where the value
/// is not above 0.
double round_scale(double value);

/// What one sample's heat map shows, by triangle or by tile. Keeps its memory between frames.
class HeatMap {
 public:
  HeatMap();

  /// Residuals of the present pose (triangle_residuals()), in percent, as indices of palette().
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
