// Colours: linear light inside, sRGB bytes at the edges; and those of a model's textures.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>

#include "common/math/vec3.h"
#include "common/motion/pose_sequence.h"

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

namespace detail {

/// Texel index for coordinate `i` of `size` texels.
inline std::uint32_t wrap_texel(std::int64_t i, std::uint32_t size, TextureWrap wrap) {
  const std::int64_t n = size;
  if (wrap == TextureWrap::kClamp)
    return static_cast<std::uint32_t>(std::clamp<std::int64_t>(i, 0, n - 1));
  const std::int64_t period = wrap == TextureWrap::kMirror ? 2 * n : n;
  const std::int64_t m = ((i % period) + period) % period;
  return static_cast<std::uint32_t>(m < n ? m : period - 1 - m);
}

}  // namespace detail

/// Linear RGB of `texture` at `uv`, blended between texels, with the material's wrapping.
/// Coordinates that are not finite count as 0.
inline Vec3f sample_texture(const Texture& texture, std::span<const std::uint32_t> texels,
                            const TexCoord& uv, const Material& material) {
  const auto texel_space = [](float c, std::uint32_t size) {
    // Past a million repeats there is no fraction left worth having.
    const double safe = std::isfinite(c) ? std::clamp<double>(c, -1e6, 1e6) : 0.0;
    return safe * size - 0.5;
  };
  const double x = texel_space(uv.u, texture.width), y = texel_space(uv.v, texture.height);
  const auto x0 = static_cast<std::int64_t>(std::floor(x)),
             y0 = static_cast<std::int64_t>(std::floor(y));
  const auto fx = static_cast<float>(x - static_cast<double>(x0));
  const auto fy = static_cast<float>(y - static_cast<double>(y0));
  const auto fetch = [&](std::int64_t i, std::int64_t j) -> Vec3f {
    const std::uint32_t column = detail::wrap_texel(i, texture.width, material.wrap_u);
    const std::uint32_t row = detail::wrap_texel(j, texture.height, material.wrap_v);
    const std::uint32_t rgba =
        texels[texture.first_texel + static_cast<std::uint64_t>(row) * texture.width + column];
    return {linear_from_srgb(rgba), linear_from_srgb(rgba >> 8), linear_from_srgb(rgba >> 16)};
  };
  const Vec3f top = fetch(x0, y0) * (1 - fx) + fetch(x0 + 1, y0) * fx;
  const Vec3f bottom = fetch(x0, y0 + 1) * (1 - fx) + fetch(x0 + 1, y0 + 1) * fx;
  return top * (1 - fy) + bottom * fy;
}

}  // namespace mdk
