// Highlight: the pixels of some triangles stand out in a picture that has been traced already.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/trace/hit_buffer.h"
#include "viewer/picture/picture.h"

namespace mdk {

/// The triangle at each pixel of `hits`, row 0 on top; kNoHit: none. Cost: O(pixels).
std::vector<std::uint32_t> triangles_of(const HitBuffer& hits);

/// What stands out, and how.
struct Highlight {
  std::uint32_t first_triangle = 0, triangle_count = 0;
  std::uint32_t color = 0;  ///< sRGB RGBA
};

/// A copy of the picture in which pixels of those triangles are tinted, and white where their area
/// ends. `triangles`: as triangles_of(), of rows `width` long; the picture has as many rows, each
/// of one or more such rows side by side.
Picture highlighted(const Picture& picture, std::span<const std::uint32_t> triangles,
                    std::uint32_t width, const Highlight& highlight);

}  // namespace mdk
