// Comparison: one picture of two, pixel by pixel.
#pragma once

#include <cstdint>
#include <span>

#include "viewer/picture/picture.h"
#include "viewer/state/compare.h"

namespace mdk {

using PixelSpan = std::span<const std::uint32_t>;

/// Two pictures of the same view; sRGB RGBA, width * height each.
struct PicturePair {
  PixelSpan first, second;
  std::uint32_t width = 0, height = 0;
};

PictureDifference difference_of(const PicturePair& pair);

/// 2 width x height: the first at the left.
Picture side_by_side(const PicturePair& pair);

/// The first's columns up to `divider` (a part of the width, in [0, 1]), the second's from there.
Picture wipe(const PicturePair& pair, float divider);

/// Black where the two agree to the bit, over a faint trace of the first picture that shows where
/// one is; where they differ, a mark from dark red (by little) to white (by much), wide enough to
/// be seen where only few pixels differ.
Picture difference_picture(const PicturePair& pair);

}  // namespace mdk
