// TriangleMesh: one pose of a mesh, as .obj and .ply files hold it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "common/motion/pose_sequence.h"

namespace mdk {

inline constexpr std::size_t kMaxMeshVertices = std::size_t{1} << 27;
inline constexpr std::size_t kMaxMeshTriangles = (std::size_t{1} << 29) / 3;

struct TriangleMesh {
  std::vector<Vec3f> vertices;
  std::vector<Triangle> triangles;
  /// Per vertex, linear RGBA, 8 bits each, red lowest; empty where no vertex has a colour.
  std::vector<std::uint32_t> vertex_colors;
  std::vector<std::string> notes;  ///< one sentence per thing left out
};

/// An sRGB colour (each channel clamped to [0, 1]) as opaque linear RGBA, red lowest.
inline std::uint32_t linear_color(const Vec3f& srgb) {
  std::uint32_t color = 0xff000000u;
  for (std::size_t i = 0; i < 3; ++i) {
    const double s = std::min(std::max(0.0, static_cast<double>(srgb[i])), 1.0);  // NaN: 0
    const double linear = s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
    color |= static_cast<std::uint32_t>(std::lround(linear * 255)) << (8 * i);
  }
  return color;
}

}  // namespace mdk
