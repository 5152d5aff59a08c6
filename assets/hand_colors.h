// Colours of the sample hand.
#pragma once

#include <array>
#include <cstdint>

#include "assets/hand_shape.h"

namespace mdk {

/// Linear RGBA, 8 bits each, at a point of the surface with unit normal `normal`: skin that is
/// redder at knuckles and fingertips, paler in the palm and darker in folds; pale nails; cloth.
std::array<std::uint8_t, 4> surface_color(const HandShape& shape, const Vec3d& p,
                                          const Vec3d& normal);

}  // namespace mdk
