// The triangles of a leaf, sixteen side by side, and what they look like in one frame's image.
// All rays of a frame leave one eye, so a triangle's forms are computed once per frame, when a tile
// first meets its leaf, and serve every tile.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/motion/pose_sequence.h"
#include "common/structures/wide_bvh.h"
#include "common/trace/kernels/frame_cache.h"

namespace mdk {

inline constexpr std::uint32_t kBlockTriangles = kLeafItems;

/// Triangles and where their corners stand among the positions. Unused lanes repeat lane 0.
struct alignas(64) TriangleBlock {
  std::uint32_t corner[3][kBlockTriangles];
  std::uint32_t triangle[kBlockTriangles];
  std::uint32_t count = 0;

  /// Lane `count` becomes `number`; `t` is that triangle.
  void push(std::uint32_t number, const Triangle& t) {
    for (int k = 0; k < 3; ++k) corner[k][count] = t.v[k];
    triangle[count++] = number;
  }
  /// To be called once after the last push().
  void pad() {
    for (std::uint32_t i = count; i < kBlockTriangles; ++i) {
      for (auto& row : corner) row[i] = row[0];
      triangle[i] = triangle[0];
    }
  }
};

/// The blocks of the leaves of `bvh`, in their order; items are triangle numbers less `first`.
void append_blocks(const WideBvh& bvh, std::span<const Triangle> triangles, std::uint32_t first,
                   std::vector<TriangleBlock>& blocks);

/// A linear form over the image, one per triangle: x X + (y Y + z).
struct alignas(64) ImageForms {
  float x[kBlockTriangles], y[kBlockTriangles], z[kBlockTriangles];
};

/// A block in the image (docs/kernels.md, "The triangle test").
struct alignas(64) ProjectedBlock {
  ImageForms edge[3];
  ImageForms nearness;  ///< 1 / depth
  /// Nearness of the deepest and of the nearest corner; infinite where one is behind the eye.
  alignas(64) float least_nearness[kBlockTriangles];
  alignas(64) float most_nearness[kBlockTriangles];
  /// First and last pixel centres a hit may be at: those within the corners' bounds, a quarter
  /// pixel wider. Without end where a corner is behind the eye.
  alignas(64) float first_x[kBlockTriangles];
  alignas(64) float last_x[kBlockTriangles];
  alignas(64) float first_y[kBlockTriangles];
  alignas(64) float last_y[kBlockTriangles];
  // One bit per triangle.
  std::uint32_t live = 0;    ///< may be hit at all
  std::uint32_t behind = 0;  ///< has a corner behind the eye
  std::uint32_t small = 0;   ///< may be hit in at most 2 x 2 pixels
};

/// The projected blocks of one frame.
using ProjectionCache = FrameCache<ProjectedBlock, 32768>;

}  // namespace mdk
