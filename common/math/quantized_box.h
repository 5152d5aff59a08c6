// QuantizedBox: a box on the 65,536 places per axis of a grid that spans another box, its frame. A
// quarter of a box's numbers matter: where thousands of boxes stand in one frame, half the memory
// holds them, each a little larger than it was.
//
//     frame.lo |----+----+----+----+----| frame.hi
//              0    1    2   ...      65535           place q: frame.lo (1 - q/65535)
//                   [ box ]                                    + frame.hi q/65535
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "common/math/aabb.h"

namespace mdk {

/// 12 bytes, as the file holds it. A box where lo <= hi in each coordinate.
struct QuantizedBox {
  std::array<std::uint16_t, 3> lo{}, hi{};

  bool operator==(const QuantizedBox&) const = default;
};
static_assert(sizeof(QuantizedBox) == 12);

/// Where a place lies: computed in double, operation by operation as written, and rounded to the
/// nearest float. Exact at both ends of the frame, never falling with q, so never outside it.
inline float grid_coordinate(float lo, float hi, std::uint16_t q) {
  const double share = q / 65535.0;
  return static_cast<float>(static_cast<double>(lo) * (1 - share) +
                            static_cast<double>(hi) * share);
}

/// The box as it lies in a finite frame: finite and inside it.
inline Aabb dequantize(const QuantizedBox& box, const Aabb& frame) {
  Aabb out;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    out.lo[axis] = grid_coordinate(frame.lo[axis], frame.hi[axis], box.lo[axis]);
    out.hi[axis] = grid_coordinate(frame.lo[axis], frame.hi[axis], box.hi[axis]);
  }
  return out;
}

/// A box on the grid of a finite frame that holds `box`, which lies inside the frame: each side
/// moves outward by less than two places.
QuantizedBox quantize_outward(const Aabb& box, const Aabb& frame);

}  // namespace mdk
