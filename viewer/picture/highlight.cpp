#include "viewer/picture/highlight.h"

#include <algorithm>

#include "common/base/error.h"

namespace mdk {
namespace {

constexpr std::uint32_t kWhite = 0xffffffffu;

/// Half of each channel from either.
std::uint32_t middle(std::uint32_t a, std::uint32_t b) {
  return (a & b) + (((a ^ b) & 0xfefefefeu) >> 1);
}

}  // namespace

std::vector<std::uint32_t> triangles_of(const HitBuffer& hits) {
  const std::uint32_t width = hits.width(), height = hits.height();
  std::vector<std::uint32_t> triangles(static_cast<std::size_t>(width) * height, kNoHit);
  for (std::size_t i = 0; i < hits.tile_count(); ++i) {
    if (!hits.is_hit(i)) continue;
    const std::uint32_t left = hits.tile_left(i), top = hits.tile_top(i);
    const std::uint32_t columns = std::min(kTileSide, width - left);
    const std::uint32_t rows = std::min(kTileSide, height - top);
    for (std::uint32_t y = 0; y < rows; ++y)
      std::copy_n(hits.tile(i).triangle + y * kTileSide, columns,
                  triangles.begin() + static_cast<std::ptrdiff_t>(top + y) * width + left);
  }
  return triangles;
}

Picture highlighted(const Picture& picture, std::span<const std::uint32_t> triangles,
                    std::uint32_t width, const Highlight& highlight) {
  const std::size_t row = width;
  if (width == 0 || picture.width % width != 0 || triangles.size() != row * picture.height)
    throw Error(ErrorCode::kInternal, "the triangles of another picture are to be highlighted");
  const auto inside = [&](std::size_t i) {
    return triangles[i] - highlight.first_triangle < highlight.triangle_count;
  };
  const std::uint32_t tint = middle(highlight.color, kWhite);
  Picture marked = picture;
  for (std::uint32_t y = 0; y < picture.height; ++y)
    for (std::uint32_t x = 0; x < width; ++x) {
      const std::size_t i = row * y + x;
      if (!inside(i)) continue;
      const bool ends = (x > 0 && !inside(i - 1)) || (x + 1 < width && !inside(i + 1)) ||
                        (y > 0 && !inside(i - row)) || (y + 1 < picture.height && !inside(i + row));
      for (std::size_t at = static_cast<std::size_t>(picture.width) * y + x;
           at < static_cast<std::size_t>(picture.width) * (y + 1); at += row)
        marked.pixels[at] = ends ? kWhite : middle(picture.pixels[at], tint);
    }
  return marked;
}

}  // namespace mdk
