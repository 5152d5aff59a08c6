// From the colours of a tile to bytes.
#pragma once

#include <cstddef>
#include <cstdint>

#include "common/trace/hit_buffer.h"

namespace mdk {

/// Linear light of a tile's pixels, at j * kTileSide + i.
struct TileColors {
  const float *red, *green, *blue;
  const std::uint32_t* triangle = nullptr;  ///< kNoHit shows the background; null: all have colours
};

/// Writes a tile as sRGB RGBA, red lowest. `background` has one pixel per row of the tile, `pixels`
/// starts with the tile's first and has rows of `stride`. Writes `columns` x `rows` of them.
void develop_tile(const TileColors& colors, const std::uint32_t* background, std::uint32_t columns,
                  std::uint32_t rows, std::uint32_t* pixels, std::size_t stride);

}  // namespace mdk
