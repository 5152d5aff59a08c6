// Points, directions and boxes: plain data. What multiplies and adds is not here but inside the
// library: compiled with a program's own flags, it could round otherwise than the library's.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>

namespace mdk {

/// Three numbers, all zero unless given.
template <class T>
struct Vec3 {
  T x{}, y{}, z{};

  T& operator[](std::size_t i) { return i == 0 ? x : i == 1 ? y : z; }
  const T& operator[](std::size_t i) const { return i == 0 ? x : i == 1 ? y : z; }

  Vec3& operator+=(const Vec3& b) { return *this = {x + b.x, y + b.y, z + b.z}; }

  friend constexpr bool operator==(const Vec3& a, const Vec3& b) {
    return a.x == b.x && a.y == b.y && a.z == b.z;
  }
  friend constexpr bool operator!=(const Vec3& a, const Vec3& b) { return !(a == b); }
};

/// What is stored and traced.
using Vec3f = Vec3<float>;

template <class T>
constexpr Vec3<T> operator+(const Vec3<T>& a, const Vec3<T>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class T>
constexpr Vec3<T> operator-(const Vec3<T>& a, const Vec3<T>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class T>
constexpr Vec3<T> operator-(const Vec3<T>& a) {
  return {-a.x, -a.y, -a.z};
}
template <class T>
constexpr Vec3<T> operator*(const Vec3<T>& a, T s) {
  return {a.x * s, a.y * s, a.z * s};
}
template <class T>
constexpr Vec3<T> operator*(T s, const Vec3<T>& a) {
  return a * s;
}

/// An axis-aligned box [lo, hi], closed on all sides. The default one is empty.
template <class T>
struct BasicAabb {
  static constexpr T kInf = std::numeric_limits<T>::infinity();
  Vec3<T> lo{kInf, kInf, kInf};
  Vec3<T> hi{-kInf, -kInf, -kInf};

  bool empty() const { return !(lo.x <= hi.x && lo.y <= hi.y && lo.z <= hi.z); }
  Vec3<T> extent() const { return hi - lo; }
  Vec3<T> center() const { return lo + (hi - lo) * T(0.5); }
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

  friend constexpr bool operator==(const BasicAabb& a, const BasicAabb& b) {
    return a.lo == b.lo && a.hi == b.hi;
  }
  friend constexpr bool operator!=(const BasicAabb& a, const BasicAabb& b) { return !(a == b); }
};

using Aabb = BasicAabb<float>;

}  // namespace mdk
