#include "common/trace/hit_buffer.h"

#include <algorithm>
#include <bit>

namespace mdk {

std::uint64_t count_mismatches(const HitBuffer& a, const HitBuffer& b) {
  std::uint64_t mismatches = 0;
  for (std::uint32_t y = 0; y < a.height(); ++y)
    for (std::uint32_t x = 0; x < a.width(); ++x)
      mismatches +=
          a.triangle(x, y) != b.triangle(x, y) ||
          std::bit_cast<std::uint32_t>(a.t(x, y)) != std::bit_cast<std::uint32_t>(b.t(x, y));
  return mismatches;
}

std::uint64_t count_hits(const HitBuffer& hits) {
  std::uint64_t count = 0;
  for (std::size_t i = 0; i < hits.tile_count(); ++i) {
    if (!hits.tile(i).written) continue;
    const std::uint32_t columns = std::min(kTileSide, hits.width() - hits.tile_left(i));
    const std::uint32_t rows = std::min(kTileSide, hits.height() - hits.tile_top(i));
    const std::uint32_t* triangle = hits.tile(i).triangle;
    std::uint32_t in_tile = 0;
    if (columns == kTileSide) {
      for (std::uint32_t p = 0; p < rows * kTileSide; ++p) in_tile += triangle[p] != kNoHit;
    } else {
      for (std::uint32_t y = 0; y < rows; ++y)
        for (std::uint32_t x = 0; x < columns; ++x)
          in_tile += triangle[y * kTileSide + x] != kNoHit;
    }
    count += in_tile;
  }
  return count;
}

}  // namespace mdk
