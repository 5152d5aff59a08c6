// What boxes measure and how they are rounded. QuantizedBox: one on a grid that spans another box,
// its frame, in half the memory.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "common/math/vec3.h"

namespace mdk {

using Aabbd = BasicAabb<double>;

/// From corner to corner; 0 for an empty box.
template <class T>
T diagonal(const BasicAabb<T>& box) {
  return box.empty() ? T(0) : length(box.extent());
}

/// Area of the six sides; 0 for an empty box.
template <class T>
T surface_area(const BasicAabb<T>& box) {
  if (box.empty()) return T(0);
  const Vec3<T> e = box.extent();
  return T(2) * (e.x * e.y + e.y * e.z + e.z * e.x);
}

template <class T>
BasicAabb<T> intersection(const BasicAabb<T>& a, const BasicAabb<T>& b) {
  return {{std::max(a.lo.x, b.lo.x), std::max(a.lo.y, b.lo.y), std::max(a.lo.z, b.lo.z)},
          {std::min(a.hi.x, b.hi.x), std::min(a.hi.y, b.hi.y), std::min(a.hi.z, b.hi.z)}};
}

/// Half the area of the six sides, in double: no box of floats is past its range. 0 for an empty
/// box.
inline double half_area(const Aabb& box) {
  if (box.empty()) return 0;
  const Vec3d e = to_double(box.hi) - to_double(box.lo);
  return e.x * e.y + e.y * e.z + e.z * e.x;
}

/// std::nextafter towards -infinity for all that is above it, without its call.
inline float next_below(float f) {
  if (f == 0) return -std::numeric_limits<float>::denorm_min();
  const auto bits = std::bit_cast<std::uint32_t>(f);
  return std::bit_cast<float>(f > 0 ? bits - 1 : bits + 1);
}
inline float round_down(double v) {
  const float f = static_cast<float>(v);
  return static_cast<double>(f) <= v ? f : next_below(f);
}
inline float round_up(double v) {
  const float f = static_cast<float>(v);
  return static_cast<double>(f) >= v ? f : -next_below(-f);
}

/// The smallest float box that holds `b`.
inline Aabb round_outward(const Aabbd& b) {
  return {{round_down(b.lo.x), round_down(b.lo.y), round_down(b.lo.z)},
          {round_up(b.hi.x), round_up(b.hi.y), round_up(b.hi.z)}};
}

/// A box on the 65,536 places per axis of a grid that spans its frame, as the file holds it; lo <=
/// hi in each coordinate. A quarter of a box's numbers matter: where thousands of boxes stand in
/// one frame, half the memory holds them, each a little larger than it was.
///
///     frame.lo |----+----+----+----+----| frame.hi
///              0    1    2   ...      65535           place q: frame.lo (1 - q/65535)
///                   [ box ]                                    + frame.hi q/65535
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
inline QuantizedBox quantize_outward(const Aabb& box, const Aabb& frame) {
  constexpr std::uint16_t kLast = 65535;
  QuantizedBox out;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const float lo = frame.lo[axis], hi = frame.hi[axis];
    // Among the places: in [0, 65535], near enough to start from; 0 where the frame is flat.
    const auto place_of = [&](float v) {
      const double place = kLast * ((static_cast<double>(v) - static_cast<double>(lo)) /
                                    (static_cast<double>(hi) - static_cast<double>(lo)));
      return place > 0 ? std::min<double>(place, kLast) : 0;
    };
    auto below = static_cast<std::uint16_t>(place_of(box.lo[axis]));
    while (below > 0 && grid_coordinate(lo, hi, below) > box.lo[axis]) --below;
    auto above = static_cast<std::uint16_t>(std::ceil(place_of(box.hi[axis])));
    while (above < kLast && grid_coordinate(lo, hi, above) < box.hi[axis]) ++above;
    out.lo[axis] = below;
    out.hi[axis] = above;
  }
  return out;
}

}  // namespace mdk
