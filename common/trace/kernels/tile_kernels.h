// Tiles of rays through a scene, behind run-time dispatch: plain data in, closest hits out.
// docs/kernels.md explains the geometry.
#pragma once

#include <cstdint>
#include <vector>

#include "common/trace/camera.h"
#include "common/trace/frame_stats.h"
#include "common/trace/hit_buffer.h"
#include "common/trace/kernels/scene.h"

namespace mdk {

/// How far outside the corners' image bounds a triangle may be hit, in pixels: more than rounding
/// moves anything by in the largest picture. Frusta allow for more (docs/kernels.md).
inline constexpr float kBoundsMargin = 0x1p-6f;

/// From a world point to the image: with p = m (v - origin), p.z is the depth t along the view axis
/// and (p.x / p.z, p.y / p.z) the image point in pixels.
struct PixelFromWorld {
  float m[3][3];
  Vec3f origin;
  float margin = kBoundsMargin;
};

PixelFromWorld make_pixel_from_world(const PinholeRays& rays);

/// One tile of 16x16 pixels with its upper left pixel at (x, y), a multiple of 16.
struct TileRays {
  const PinholeRays* rays;
  const PixelFromWorld* pixel_from_world;
  std::uint32_t x, y;
};

/// Per-thread memory of the kernels: which triangles and clusters this tile has already seen.
struct TileScratch {
  std::vector<std::uint32_t> triangle_stamps, cluster_stamps;
  std::uint32_t serial = 0;
  ProjectedBlock block;

  /// Begins a tile: afterwards nothing has been seen. Grows the stamps on first use.
  void begin_tile(std::size_t triangles, std::size_t clusters);
};

/// Closest hits, ties to the lower triangle. Returns whether a ray hits; `hits` is written whole
/// then, and else left alone. The same hits with every structure, to the bit; the same hits and
/// counts on every machine. `counters` may be null.
bool trace_tile(const TileRays& tile, const TraceScene& scene, TileHits& hits, TileScratch& scratch,
                TraceCounters* counters);

}  // namespace mdk
