// Bilinear look-up of a model's textures.
#pragma once

#include <span>

#include "common/motion/appearance.h"
#include "common/trace/color.h"

namespace mdk {

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

/// Linear RGB of `texture` at `uv`, with the material's wrapping. Coordinates that are not finite
/// count as 0.
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
