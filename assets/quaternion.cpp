#include "assets/quaternion.h"

#include <cmath>
#include <numbers>

namespace mdk {

Quaternion operator*(const Quaternion& a, const Quaternion& b) {
  return {
      a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y, a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
      a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w, a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z};
}

Quaternion rotation_about(std::size_t axis, double degrees) {
  const double half = degrees * std::numbers::pi / 360;
  const double s = std::sin(half);
  return {axis == 0 ? s : 0, axis == 1 ? s : 0, axis == 2 ? s : 0, std::cos(half)};
}

Quaternion rotation_between(const Basis& parent, const Basis& child) {
  // Columns: the child's axes in the parent's. The trace of a turn below 180 degrees is above -1.
  const Vec3d x = parent.vector_to_local(child.x), y = parent.vector_to_local(child.y),
              z = parent.vector_to_local(child.z);
  const double w = 0.5 * std::sqrt(1 + x.x + y.y + z.z);
  const double s = 0.25 / w;
  return {(y.z - z.y) * s, (z.x - x.z) * s, (x.y - y.x) * s, w};
}

}  // namespace mdk
