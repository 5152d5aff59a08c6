#include "common/trace/hit_buffer.h"

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
  for (std::uint32_t y = 0; y < hits.height(); ++y)
    for (std::uint32_t x = 0; x < hits.width(); ++x) count += hits.triangle(x, y) != kNoHit;
  return count;
}

}  // namespace mdk
