// Unit quaternions as rotations, in double.
#pragma once

#include <algorithm>
#include <cmath>

#include "common/math/affine3.h"

namespace mdk::gltf {

struct Quaternion {
  double x = 0, y = 0, z = 0, w = 1;
};

inline double dot(const Quaternion& a, const Quaternion& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w;
}
inline Quaternion operator*(const Quaternion& a, double s) {
  return {a.x * s, a.y * s, a.z * s, a.w * s};
}
inline Quaternion operator+(const Quaternion& a, const Quaternion& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z, a.w + b.w};
}

/// Of length one; no rotation where `q` is zero. Safe from overflow and underflow.
inline Quaternion normalized(const Quaternion& q) {
  const double largest = std::max({std::abs(q.x), std::abs(q.y), std::abs(q.z), std::abs(q.w)});
  if (!(largest > 0)) return {};
  const Quaternion scaled{q.x / largest, q.y / largest, q.z / largest, q.w / largest};
  return scaled * (1.0 / std::sqrt(dot(scaled, scaled)));
}

/// Spherical interpolation along the shorter arc, s in [0, 1]; a and b of length one.
inline Quaternion slerp(const Quaternion& a, Quaternion b, double s) {
  if (dot(a, b) < 0) b = b * -1.0;
  // The chord gives the angle accurately where it is small, which acos of the dot product does not.
  const Quaternion chord = b + a * -1.0;
  const double angle = 2.0 * std::asin(std::min(1.0, 0.5 * std::sqrt(dot(chord, chord))));
  if (angle < 1e-9) return a;
  const double scale = 1.0 / std::sin(angle);
  return normalized(a * (std::sin((1.0 - s) * angle) * scale) + b * (std::sin(s * angle) * scale));
}

/// Translation after rotation after scale; `q` of length one.
inline Affine3d compose(const Vec3d& translation, const Quaternion& q, const Vec3d& scale) {
  const double xx = q.x * q.x, yy = q.y * q.y, zz = q.z * q.z;
  const double xy = q.x * q.y, xz = q.x * q.z, yz = q.y * q.z;
  const double wx = q.w * q.x, wy = q.w * q.y, wz = q.w * q.z;
  return {{{(1 - 2 * (yy + zz)) * scale.x, 2 * (xy - wz) * scale.y, 2 * (xz + wy) * scale.z,
            translation.x},
           {2 * (xy + wz) * scale.x, (1 - 2 * (xx + zz)) * scale.y, 2 * (yz - wx) * scale.z,
            translation.y},
           {2 * (xz - wy) * scale.x, 2 * (yz + wx) * scale.y, (1 - 2 * (xx + yy)) * scale.z,
            translation.z}}};
}

}  // namespace mdk::gltf
