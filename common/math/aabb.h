// Aabb: an axis-aligned box [lo, hi], closed on all sides. The default one is empty.
#pragma once

#include <algorithm>
#include <limits>

#include "common/math/vec3.h"

namespace mdk {

template <class T>
struct BasicAabb {
  static constexpr T kInf = std::numeric_limits<T>::infinity();
  Vec3<T> lo{kInf, kInf, kInf};
  Vec3<T> hi{-kInf, -kInf, -kInf};

  bool empty() const { return !(lo.x <= hi.x && lo.y <= hi.y && lo.z <= hi.z); }
  Vec3<T> extent() const { return hi - lo; }
  Vec3<T> center() const { return {mid(lo.x, hi.x), mid(lo.y, hi.y), mid(lo.z, hi.z)}; }
  T diagonal() const { return empty() ? T(0) : length(extent()); }
  /// Area of the six sides; 0 for an empty box.
  T surface_area() const {
    if (empty()) return T(0);
    const Vec3<T> e = extent();
    return T(2) * (e.x * e.y + e.y * e.z + e.z * e.x);
  }
  bool contains(const Vec3<T>& p) const {
    return lo.x <= p.x && p.x <= hi.x && lo.y <= p.y && p.y <= hi.y && lo.z <= p.z && p.z <= hi.z;
  }
  bool contains(const BasicAabb& b) const {
    return b.empty() || (contains(b.lo) && contains(b.hi));
  }

  void extend(const Vec3<T>& p) {
    lo = {std::min(lo.x, p.x), std::min(lo.y, p.y), std::min(lo.z, p.z)};
    hi = {std::max(hi.x, p.x), std::max(hi.y, p.y), std::max(hi.z, p.z)};
  }
  void extend(const BasicAabb& b) {
    lo = {std::min(lo.x, b.lo.x), std::min(lo.y, b.lo.y), std::min(lo.z, b.lo.z)};
    hi = {std::max(hi.x, b.hi.x), std::max(hi.y, b.hi.y), std::max(hi.z, b.hi.z)};
  }

  bool operator==(const BasicAabb&) const = default;

 private:
  static T mid(T a, T b) { return a + (b - a) * T(0.5); }
};

using Aabb = BasicAabb<float>;
using Aabbd = BasicAabb<double>;

template <class T>
BasicAabb<T> intersection(const BasicAabb<T>& a, const BasicAabb<T>& b) {
  return {{std::max(a.lo.x, b.lo.x), std::max(a.lo.y, b.lo.y), std::max(a.lo.z, b.lo.z)},
          {std::min(a.hi.x, b.hi.x), std::min(a.hi.y, b.hi.y), std::min(a.hi.z, b.hi.z)}};
}

inline float round_down(double v) {
  const float f = static_cast<float>(v);
  return static_cast<double>(f) <= v ? f
                                     : std::nextafter(f, -std::numeric_limits<float>::infinity());
}
inline float round_up(double v) {
  const float f = static_cast<float>(v);
  return static_cast<double>(f) >= v ? f
                                     : std::nextafter(f, std::numeric_limits<float>::infinity());
}

/// The smallest float box that holds `b`.
inline Aabb round_outward(const Aabbd& b) {
  return {{round_down(b.lo.x), round_down(b.lo.y), round_down(b.lo.z)},
          {round_up(b.hi.x), round_up(b.hi.y), round_up(b.hi.z)}};
}

}  // namespace mdk
