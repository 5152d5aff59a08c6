#include "common/trace/hit_buffer.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace mdk {
namespace {

bool is_same_hit(std::uint32_t triangle_a, float t_a, std::uint32_t triangle_b, float t_b,
                 Agreement agreement) {
  if (agreement == Agreement::kBitIdentical)
    return triangle_a == triangle_b &&
           std::bit_cast<std::uint32_t>(t_a) == std::bit_cast<std::uint32_t>(t_b);
  if (triangle_a == triangle_b) return true;
  const bool both_hit = triangle_a != kNoHit && triangle_b != kNoHit;
  return both_hit && std::abs(t_a - t_b) <= 1e-5f * std::max(t_a, t_b);
}

}  // namespace

std::uint64_t count_mismatches(const HitBuffer& a, const HitBuffer& b, Agreement agreement) {
  std::uint64_t mismatches = 0;
  for (std::uint32_t y = 0; y < a.height(); ++y)
    for (std::uint32_t x = 0; x < a.width(); ++x)
      mismatches +=
          !is_same_hit(a.triangle(x, y), a.t(x, y), b.triangle(x, y), b.t(x, y), agreement);
  return mismatches;
}

std::uint64_t count_hits(const HitBuffer& hits) {
  std::uint64_t count = 0;
  for (std::size_t i = 0; i < hits.tile_count(); ++i) {
    if (!hits.is_hit(i)) continue;
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
