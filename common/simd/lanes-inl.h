// The words all SIMD code shares: a point in each lane, and the bits of a mask. Compiled once per
// instruction set, as every *-inl.h: Highway includes it anew for each, so its guard is toggled.
#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "common/math/vec3.h"

#if defined(MDK_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MDK_LANES_INL_H_
#undef MDK_LANES_INL_H_
#else
#define MDK_LANES_INL_H_
#endif

HWY_BEFORE_NAMESPACE();
namespace mdk {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// As many floats as a vector holds, sixteen at most: a block of triangles, a row of a tile.
using FloatTag = hn::CappedTag<float, 16>;
using FloatVec = hn::Vec<FloatTag>;
using FloatMask = hn::Mask<FloatTag>;

/// The bits of a mask of at most sixteen lanes, lane 0 lowest.
template <class D>
HWY_INLINE std::uint32_t mask_bits(D d, hn::Mask<D> mask) {
  static_assert(hn::MaxLanes(D()) <= 16);
  alignas(8) std::uint8_t bits[8] = {};
  hn::StoreMaskBits(d, mask, bits);
  std::uint16_t all;
  std::memcpy(&all, bits, sizeof all);  // of little-endian machines, as Highway's targets are
  return all & ((1u << hn::Lanes(d)) - 1);
}

/// The smallest of sixteen numbers, which are aligned.
HWY_INLINE float min_of_sixteen(const float* values) {
  const FloatTag d;
  auto min = hn::Load(d, values);
  for (std::size_t i = hn::Lanes(d); i < 16; i += hn::Lanes(d))
    min = hn::Min(min, hn::Load(d, values + i));
  return hn::GetLane(hn::MinOfLanes(d, min));
}
HWY_INLINE float max_of_sixteen(const float* values) {
  const FloatTag d;
  auto max = hn::Load(d, values);
  for (std::size_t i = hn::Lanes(d); i < 16; i += hn::Lanes(d))
    max = hn::Max(max, hn::Load(d, values + i));
  return hn::GetLane(hn::MaxOfLanes(d, max));
}

/// A point or a direction in each lane.
template <class D>
struct Points {
  hn::Vec<D> x, y, z;
};

template <class D>
HWY_INLINE Points<D> operator+(const Points<D>& a, const Points<D>& b) {
  return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}
template <class D>
HWY_INLINE Points<D> operator-(const Points<D>& a, const Points<D>& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
template <class D>
HWY_INLINE Points<D> scaled(const Points<D>& a, hn::Vec<D> s) {
  return {hn::Mul(a.x, s), hn::Mul(a.y, s), hn::Mul(a.z, s)};
}
template <class D>
HWY_INLINE hn::Vec<D> dot(const Points<D>& a, const Points<D>& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
template <class D>
HWY_INLINE Points<D> cross(const Points<D>& a, const Points<D>& b) {
  return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)),
          hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
          hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x))};
}
/// |x| + |y| + |z|.
template <class D>
HWY_INLINE hn::Vec<D> sum_of_sizes(const Points<D>& a) {
  return hn::Add(hn::Add(hn::Abs(a.x), hn::Abs(a.y)), hn::Abs(a.z));
}
/// (b - a) x (b + a): twice b x a, and exactly negated when a and b change places. Its dot product
/// with a ray through the origin says on which side of the edge ab the ray passes.
template <class D>
HWY_INLINE Points<D> edge_form(const Points<D>& a, const Points<D>& b) {
  return cross(b - a, b + a);
}

/// The same in every lane.
template <class D>
HWY_INLINE Points<D> broadcast(D d, const Vec3<hn::TFromD<D>>& v) {
  return {hn::Set(d, v.x), hn::Set(d, v.y), hn::Set(d, v.z)};
}
template <class D>
HWY_INLINE void store(D d, const Points<D>& p, hn::TFromD<D>* x, hn::TFromD<D>* y,
                      hn::TFromD<D>* z) {
  hn::Store(p.x, d, x);
  hn::Store(p.y, d, y);
  hn::Store(p.z, d, z);
}
/// points[index] of each lane; `indices` is aligned.
template <class D>
HWY_INLINE Points<D> gather(D d, const std::uint32_t* indices, const Vec3f* points) {
  const hn::RebindToSigned<D> di;
  static_assert(sizeof(Vec3f) == 3 * sizeof(float));
  const auto v = hn::BitCast(di, hn::Load(hn::RebindToUnsigned<D>(), indices));
  const auto index = hn::Add(v, hn::Add(v, v));
  const float* base = &points->x;
  return {hn::GatherIndex(d, base, index), hn::GatherIndex(d, base + 1, index),
          hn::GatherIndex(d, base + 2, index)};
}

}  // namespace HWY_NAMESPACE
}  // namespace mdk
HWY_AFTER_NAMESPACE();

#endif  // per-target guard
