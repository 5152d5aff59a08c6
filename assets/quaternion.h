// Rotations as unit quaternions.
#pragma once

#include <cstddef>

#include "assets/distance_field.h"

namespace mdk {

struct Quaternion {
  double x = 0, y = 0, z = 0, w = 1;
};

/// First `b`, then `a`.
Quaternion operator*(const Quaternion& a, const Quaternion& b);

/// By `degrees` about axis 0 (x), 1 (y) or 2 (z), counter-clockwise seen from its tip.
Quaternion rotation_about(std::size_t axis, double degrees);

/// The rotation that takes the axes of `parent` to those of `child`; less than half a turn.
Quaternion rotation_between(const Basis& parent, const Basis& child);

}  // namespace mdk
