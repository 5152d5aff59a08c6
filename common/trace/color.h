// Colours: linear light inside, sRGB bytes at the edges.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "common/math/vec3.h"

namespace mdk {

/// An sRGB byte as linear light in [0, 1].
inline float linear_from_srgb(std::uint32_t byte) {
  static const std::array<float, 256> table = [] {
    std::array<float, 256> t{};
    for (std::size_t i = 0; i < t.size(); ++i) {
      const double c = static_cast<double>(i) / 255;
      t[i] = static_cast<float>(c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4));
    }
    return t;
  }();
  return table[byte & 255u];
}

inline constexpr float kLastSrgbStep = 4095;

/// sRGB bytes for linear light in steps from 0 to kLastSrgbStep, then four bytes more, so that each
/// can be fetched with three that follow it.
inline const std::array<std::uint8_t, 4100>& srgb_table() {
  static const std::array<std::uint8_t, 4100> table = [] {
    std::array<std::uint8_t, 4100> t{};
    for (std::size_t i = 0; i < 4096; ++i) {
      const double l = static_cast<double>(i) / 4095;
      const double c = l <= 0.0031308 ? 12.92 * l : 1.055 * std::pow(l, 1 / 2.4) - 0.055;
      t[i] = static_cast<std::uint8_t>(std::lround(c * 255));
    }
    return t;
  }();
  return table;
}

/// The step of srgb_table() for linear light; clamped to [0, 1], and black where it is not a
/// number.
inline std::int32_t srgb_step(float linear) {
  const float clamped = linear > 0 ? std::min(linear, 1.0f) : 0.0f;
  return static_cast<std::int32_t>(clamped * kLastSrgbStep + 0.5f);
}

/// Linear light as an sRGB byte.
inline std::uint32_t srgb_from_linear(float linear) {
  return srgb_table()[static_cast<std::size_t>(srgb_step(linear))];
}

/// Opaque sRGB RGBA with red lowest.
inline std::uint32_t pack_srgb(const Vec3f& linear) {
  return srgb_from_linear(linear.x) | srgb_from_linear(linear.y) << 8 |
         srgb_from_linear(linear.z) << 16 | 0xff000000u;
}

inline Vec3f multiply(const Vec3f& a, const Vec3f& b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }

}  // namespace mdk
