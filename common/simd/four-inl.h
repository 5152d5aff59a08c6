// Four: the three components of a point, a direction or a box's corner, and a lane to spare, in one
// vector where the instruction set has one of that size, in an array elsewhere.
#include "common/simd/lanes-inl.h"

#if defined(MDK_FOUR_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MDK_FOUR_INL_H_
#undef MDK_FOUR_INL_H_
#else
#define MDK_FOUR_INL_H_
#endif

#include <cmath>
#include <type_traits>

HWY_BEFORE_NAMESPACE();
namespace mdk {
namespace HWY_NAMESPACE {

template <class T, bool kIsVector = hn::MaxLanes(hn::CappedTag<T, 4>()) == 4>
class Four {
 public:
  using Item = T;
  static HWY_INLINE Four all(T value) { return {{value, value, value, value}}; }
  static HWY_INLINE Four load(const T* from) { return {{from[0], from[1], from[2], from[3]}}; }
  HWY_INLINE void store(T* to) const {
    for (int i = 0; i < 4; ++i) to[i] = v[i];
  }
  template <class Op>
  HWY_INLINE Four with(const Four& b, const Op& op) const {
    return {{op(v[0], b.v[0]), op(v[1], b.v[1]), op(v[2], b.v[2]), op(v[3], b.v[3])}};
  }
  friend HWY_INLINE Four operator+(const Four& a, const Four& b) {
    return a.with(b, [](T x, T y) { return x + y; });
  }
  friend HWY_INLINE Four operator-(const Four& a, const Four& b) {
    return a.with(b, [](T x, T y) { return x - y; });
  }
  friend HWY_INLINE Four operator*(const Four& a, const Four& b) {
    return a.with(b, [](T x, T y) { return x * y; });
  }
  friend HWY_INLINE Four operator/(const Four& a, const Four& b) {
    return a.with(b, [](T x, T y) { return x / y; });
  }
  friend HWY_INLINE Four max(const Four& a, const Four& b) {
    return a.with(b, [](T x, T y) { return x > y ? x : y; });
  }
  friend HWY_INLINE Four min(const Four& a, const Four& b) {
    return a.with(b, [](T x, T y) { return x < y ? x : y; });
  }
  friend HWY_INLINE Four abs(const Four& a) {
    return a.with(a, [](T x, T) { return std::abs(x); });
  }
  friend HWY_INLINE Four with_sign(const Four& size, const Four& sign) {
    return size.with(sign, [](T x, T y) { return std::copysign(x, y); });
  }
  friend HWY_INLINE Four if_negative(const Four& a, const Four& yes, const Four& no) {
    Four r;
    for (int i = 0; i < 4; ++i) r.v[i] = std::signbit(a.v[i]) ? yes.v[i] : no.v[i];
    return r;
  }
  /// A bit for each lane below zero.
  HWY_INLINE std::uint32_t negative() const {
    std::uint32_t bits = 0;
    for (int i = 0; i < 4; ++i) bits |= static_cast<std::uint32_t>(v[i] < 0) << i;
    return bits;
  }
  /// Lanes 1, 2, 0, 3.
  HWY_INLINE Four turned() const { return {{v[1], v[2], v[0], v[3]}}; }
  HWY_INLINE Four last() const { return all(v[3]); }
  HWY_INLINE T sum() const { return (v[0] + v[1]) + (v[2] + v[3]); }

  T v[4];
};

template <class T>
class Four<T, true> {
 public:
  using Item = T;
  using D = hn::FixedTag<T, 4>;
  static HWY_INLINE Four all(T value) { return {hn::Set(D(), value)}; }
  static HWY_INLINE Four load(const T* from) { return {hn::LoadU(D(), from)}; }
  HWY_INLINE void store(T* to) const { hn::StoreU(v, D(), to); }
  friend HWY_INLINE Four operator+(const Four& a, const Four& b) { return {hn::Add(a.v, b.v)}; }
  friend HWY_INLINE Four operator-(const Four& a, const Four& b) { return {hn::Sub(a.v, b.v)}; }
  friend HWY_INLINE Four operator*(const Four& a, const Four& b) { return {hn::Mul(a.v, b.v)}; }
  friend HWY_INLINE Four operator/(const Four& a, const Four& b) { return {hn::Div(a.v, b.v)}; }
  friend HWY_INLINE Four max(const Four& a, const Four& b) { return {hn::Max(a.v, b.v)}; }
  friend HWY_INLINE Four min(const Four& a, const Four& b) { return {hn::Min(a.v, b.v)}; }
  friend HWY_INLINE Four abs(const Four& a) { return {hn::Abs(a.v)}; }
  friend HWY_INLINE Four with_sign(const Four& size, const Four& sign) {
    return {hn::CopySign(size.v, sign.v)};
  }
  friend HWY_INLINE Four if_negative(const Four& a, const Four& yes, const Four& no) {
    return {hn::IfNegativeThenElse(a.v, yes.v, no.v)};
  }
  HWY_INLINE std::uint32_t negative() const { return mask_bits(D(), hn::Lt(v, hn::Zero(D()))); }
  HWY_INLINE Four turned() const {
    using Index = hn::TFromD<hn::RebindToSigned<D>>;
    alignas(32) static constexpr Index kTurn[4] = {1, 2, 0, 3};
    return {hn::TableLookupLanes(v, hn::SetTableIndices(D(), kTurn))};
  }
  HWY_INLINE Four last() const {
    using Index = hn::TFromD<hn::RebindToSigned<D>>;
    alignas(32) static constexpr Index kLast[4] = {3, 3, 3, 3};
    return {hn::TableLookupLanes(v, hn::SetTableIndices(D(), kLast))};
  }
  HWY_INLINE T sum() const { return hn::GetLane(hn::SumOfLanes(D(), v)); }

  hn::Vec<D> v;
};

using FourFloats = Four<float>;
using FourDoubles = Four<double>;

template <class To, class From>
HWY_INLINE To convert_four(const From& from) {
  if constexpr (std::is_array_v<decltype(To::v)> || std::is_array_v<decltype(From::v)>) {
    using T = typename To::Item;
    typename From::Item f[4];
    from.store(f);
    const T t[4] = {static_cast<T>(f[0]), static_cast<T>(f[1]), static_cast<T>(f[2]),
                    static_cast<T>(f[3])};
    return To::load(t);
  } else if constexpr (sizeof(typename To::Item) > sizeof(typename From::Item)) {
    return {hn::PromoteTo(typename To::D(), from.v)};
  } else {
    return {hn::DemoteTo(typename To::D(), from.v)};
  }
}
HWY_INLINE FourDoubles to_double(const FourFloats& a) { return convert_four<FourDoubles>(a); }
HWY_INLINE FourFloats to_float(const FourDoubles& a) { return convert_four<FourFloats>(a); }

}  // namespace HWY_NAMESPACE
}  // namespace mdk
HWY_AFTER_NAMESPACE();

#endif  // per-target guard
