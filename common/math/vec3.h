// Vec3's products and lengths, and its precision: float for what is stored and traced, double for
// what is fitted.
#pragma once

#include <cmath>

#include "mdk/geometry.h"

namespace mdk {

using Vec3d = Vec3<double>;

template <class T>
constexpr T dot(const Vec3<T>& a, const Vec3<T>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T>
constexpr Vec3<T> cross(const Vec3<T>& a, const Vec3<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class T>
T length(const Vec3<T>& a) {
  return std::sqrt(dot(a, a));
}
/// The unit vector along `a`, or `fallback` where `a` has no direction.
template <class T>
Vec3<T> normalized(const Vec3<T>& a, const Vec3<T>& fallback = {T(0), T(0), T(1)}) {
  const T len = length(a);
  return len > T(0) ? a * (T(1) / len) : fallback;
}

inline Vec3d to_double(const Vec3f& a) { return {a.x, a.y, a.z}; }
inline Vec3f to_float(const Vec3d& a) {
  return {static_cast<float>(a.x), static_cast<float>(a.y), static_cast<float>(a.z)};
}

}  // namespace mdk
