// Point caches written byte by byte, as their formats say.
#pragma once

#include <bit>
#include <cstdint>
#include <string_view>
#include <vector>

#include "common/math/vec3.h"

namespace mdk::test {

using CacheBytes = std::vector<unsigned char>;

inline void append_word(CacheBytes& bytes, std::uint32_t word, std::endian order) {
  for (int i = 0; i < 4; ++i) {
    const int shift = order == std::endian::little ? 8 * i : 8 * (3 - i);
    bytes.push_back(static_cast<unsigned char>(word >> shift));
  }
}

inline void append_float(CacheBytes& bytes, float value, std::endian order) {
  append_word(bytes, std::bit_cast<std::uint32_t>(value), order);
}

inline void append_points(CacheBytes& bytes, const std::vector<Vec3f>& points, std::endian order) {
  for (const Vec3f& p : points)
    for (std::size_t a = 0; a < 3; ++a) append_float(bytes, p[a], order);
}

/// All frames one after the other in `points`.
inline CacheBytes pc2_bytes(std::uint32_t frames, const std::vector<Vec3f>& points,
                            float rate = 1) {
  CacheBytes bytes;
  for (const char c : std::string_view("POINTCACHE2\0", 12))
    bytes.push_back(static_cast<unsigned char>(c));
  append_word(bytes, 1, std::endian::little);
  append_word(bytes, static_cast<std::uint32_t>(points.size() / frames), std::endian::little);
  append_float(bytes, 0, std::endian::little);
  append_float(bytes, rate, std::endian::little);
  append_word(bytes, frames, std::endian::little);
  append_points(bytes, points, std::endian::little);
  return bytes;
}

inline CacheBytes mdd_bytes(const std::vector<float>& seconds, const std::vector<Vec3f>& points) {
  CacheBytes bytes;
  append_word(bytes, static_cast<std::uint32_t>(seconds.size()), std::endian::big);
  append_word(bytes, static_cast<std::uint32_t>(points.size() / seconds.size()), std::endian::big);
  for (const float time : seconds) append_float(bytes, time, std::endian::big);
  append_points(bytes, points, std::endian::big);
  return bytes;
}

}  // namespace mdk::test
