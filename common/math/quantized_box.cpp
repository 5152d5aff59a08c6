#include "common/math/quantized_box.h"

#include <algorithm>

namespace mdk {
namespace {

constexpr std::uint16_t kLast = 65535;

/// Where a coordinate of the frame lies among the places: in [0, 65535], near enough to start from.
double place_of(float v, float lo, float hi) {
  const double place = kLast * ((static_cast<double>(v) - static_cast<double>(lo)) /
                                (static_cast<double>(hi) - static_cast<double>(lo)));
  return place > 0 ? std::min<double>(place, kLast) : 0;  // 0 where the frame is flat
}

std::uint16_t place_below(float v, float lo, float hi) {
  auto q = static_cast<std::uint16_t>(place_of(v, lo, hi));
  while (q > 0 && grid_coordinate(lo, hi, q) > v) --q;
  return q;
}

std::uint16_t place_above(float v, float lo, float hi) {
  auto q = static_cast<std::uint16_t>(std::ceil(place_of(v, lo, hi)));
  while (q < kLast && grid_coordinate(lo, hi, q) < v) ++q;
  return q;
}

}  // namespace

QuantizedBox quantize_outward(const Aabb& box, const Aabb& frame) {
  QuantizedBox out;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    out.lo[axis] = place_below(box.lo[axis], frame.lo[axis], frame.hi[axis]);
    out.hi[axis] = place_above(box.hi[axis], frame.lo[axis], frame.hi[axis]);
  }
  return out;
}

}  // namespace mdk
