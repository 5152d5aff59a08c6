// Boxes against single rays, and the ray in the bases of clusters.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "common/simd/four-inl.h"
#include "common/trace/kernels/ray_kernels.h"

#if defined(MDK_RAY_BOXES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MDK_RAY_BOXES_INL_H_
#undef MDK_RAY_BOXES_INL_H_
#else
#define MDK_RAY_BOXES_INL_H_
#endif

HWY_BEFORE_NAMESPACE();
namespace mdk {
namespace HWY_NAMESPACE {
namespace rays {

/// A component so small moves the ray by less than any slack on its way to anything; kept from
/// zero, its inverse is finite.
constexpr float kShortest = 1e-20f;
/// Past this, products might overflow.
constexpr float kLargestReach = 0x1p59f, kLeastStretch = 1e-12f;

/// A ray against boxes of one basis. It meets a plane at t = plane * inverse + near or + far; each
/// box being moved outward by a slack, there are two of them. Rounding -origin * inverse moves a
/// plane by 2^-24 of the origin's size, which the slack allows for.
struct BoxRay {
  alignas(16) float near[4], far[4], inverse[4];
  std::uint32_t near_row[3];  ///< in rows of planes, low x, high x, low y...: what is met first
  float t_begin;              ///< what ends before it is not entered

  HWY_INLINE BoxRay(const FourFloats& origin, const FourFloats& direction, const FourFloats& slack,
                    float begin)
      : t_begin(begin) {
    const FourFloats one = FourFloats::all(1);
    const FourFloats inverted =
        one / with_sign(max(abs(direction), FourFloats::all(kShortest)), direction);
    const FourFloats for_low = FourFloats::all(0) - (origin + slack) * inverted,
                     for_high = FourFloats::all(0) - (origin - slack) * inverted;
    if_negative(inverted, for_high, for_low).store(near);
    if_negative(inverted, for_low, for_high).store(far);
    inverted.store(inverse);
    const std::uint32_t falls = inverted.negative();
    for (std::uint32_t k = 0; k < 3; ++k) near_row[k] = 2 * k + (falls >> k & 1u);
  }

  /// Enters every box.
  void enter_all() {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    for (std::size_t k = 0; k < 4; ++k) {
      inverse[k] = 0;
      near[k] = -kInfinity;
      far[k] = kInfinity;
    }
  }

  /// One box, whether it is entered before t_max.
  HWY_INLINE bool enters(const FourFloats& lo, const FourFloats& hi, float t_max) const {
    const FourFloats inverted = FourFloats::load(inverse);
    alignas(16) float enter[4], leave[4];
    (if_negative(inverted, hi, lo) * inverted + FourFloats::load(near)).store(enter);
    (if_negative(inverted, lo, hi) * inverted + FourFloats::load(far)).store(leave);
    return std::max({t_begin, enter[0], enter[1], enter[2]}) <=
           std::min({t_max, leave[0], leave[1], leave[2]});
  }
};

/// The same with its numbers in every lane.
template <class D>
class LaneRay {
 public:
  HWY_INLINE LaneRay(D d, const BoxRay& ray) : t_begin_(hn::Set(d, ray.t_begin)) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      near_row_[axis] = ray.near_row[axis];
      near_[axis] = hn::Set(d, ray.near[axis]);
      far_[axis] = hn::Set(d, ray.far[axis]);
      inverse_[axis] = hn::Set(d, ray.inverse[axis]);
    }
  }

  /// Bits of the boxes entered before t_max; where, into `order`. row(i) is a vector of planes.
  template <class Row>
  HWY_INLINE std::uint32_t enter(D d, float t_max, float* order, const Row& row) const {
    auto near = t_begin_, far = hn::Set(d, t_max);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      near = hn::Max(near, hn::MulAdd(row(near_row_[axis]), inverse_[axis], near_[axis]));
      far = hn::Min(far, hn::MulAdd(row(near_row_[axis] ^ 1u), inverse_[axis], far_[axis]));
    }
    hn::Store(near, d, order);
    return mask_bits(d, hn::Le(near, far));
  }

 private:
  hn::Vec<D> near_[3], far_[3], inverse_[3], t_begin_;
  std::uint32_t near_row_[3];
};

/// A ray on its way down one cluster's tree (walk-inl.h).
class RayInTree {
 public:
  HWY_INLINE RayInTree(const BoxRay& ray, const RayNode* nodes, const RayBlock* blocks, RayAim aim,
                       const RayHit& hit)
      : ray_(Tag(), ray), nodes_(nodes), blocks_(blocks), aim_(aim), hit_(hit) {}

  HWY_INLINE std::uint32_t enter(const RayNode& node, float (&order)[kRayWidth]) const {
    const Tag d;
    std::uint32_t entered = 0;
    for (std::size_t first = 0; first < kRayWidth; first += hn::Lanes(d))
      entered |= ray_.enter(d, hit_.t, order + first, [&](std::uint32_t row) {
        return hn::Load(d, node.bounds[row] + first);
      }) << first;
    return entered & ((1u << node.count) - 1);
  }
  HWY_INLINE void expect(WideBvhChild child) const {
    const char* at = child.is_leaf() ? reinterpret_cast<const char*>(blocks_ + child.index())
                                     : reinterpret_cast<const char*>(nodes_ + child.index());
    for (int line = 0; line < (child.is_leaf() ? 3 : 7); ++line) hwy::Prefetch(at + 64 * line);
  }
  bool is_past(float order) const { return order > hit_.t; }
  bool finished() const { return aim_ == RayAim::kAny && hit_.triangle != kNoHit; }

 private:
  using Tag = hn::CappedTag<float, kRayWidth>;
  LaneRay<Tag> ray_;
  const RayNode* nodes_;
  const RayBlock* blocks_;
  RayAim aim_;
  const RayHit& hit_;
};

/// The ray by the inverse of a map that is interpolated between two keys, without its origins.
struct MappedRay {
  FourFloats origin, direction;
  FourFloats stretch;       ///< what the inverse makes of a box of half side 1, along each axis
  bool is_extreme = false;  ///< maps to numbers that boxes in float are not proven for
};

/// With rows X, Y, Z of the map's linear part, its inverse has the columns Y x Z, Z x X and X x Y,
/// over X . (Y x Z). They stand here in the order z, x, y.
HWY_INLINE MappedRay map_ray(const KeyMap& from, const KeyMap& to, float s, const Vec3d& direction,
                             const Vec3d& origin) {
  const FourDoubles share = FourDoubles::all(static_cast<double>(s));
  const auto row = [&](int j) {
    const FourDoubles a = to_double(FourFloats::load(from.m[j])),
                      b = to_double(FourFloats::load(to.m[j]));
    return a + (b - a) * share;
  };
  const FourDoubles x = row(0), y = row(1), z = row(2);
  const FourDoubles tx = x.turned(), ty = y.turned(), tz = z.turned();
  const FourDoubles cx = y * tz - ty * z, cy = z * tx - tz * x, cz = x * ty - tx * y;
  // The last lane of a column is 0: the same numbers stand there on both sides.
  const FourDoubles scale = FourDoubles::all(1 / (cx * tx.turned()).sum());
  const auto all = [](double v) { return FourDoubles::all(v); };
  const FourDoubles o = cx * (all(origin.x) - x.last()) + cy * (all(origin.y) - y.last()) +
                        cz * (all(origin.z) - z.last());
  const FourDoubles d = cx * all(direction.x) + cy * all(direction.y) + cz * all(direction.z);
  return {to_float((o * scale).turned()), to_float((d * scale).turned()),
          to_float(((abs(cx) + abs(cy) + abs(cz)) * abs(scale)).turned())};
}

/// The same for a map that is not regular (AffinePath).
inline MappedRay map_irregular(const Affine3d& local_from_world, const Vec3d& direction,
                               const Vec3d& origin) {
  const Vec3d o = local_from_world.point(origin), d = local_from_world.vector(direction);
  float stretch[4] = {};
  for (std::size_t k = 0; k < 3; ++k) {
    const double* row = local_from_world.m[k];
    stretch[k] = static_cast<float>(std::abs(row[0]) + std::abs(row[1]) + std::abs(row[2]));
  }
  return {to_float(FourDoubles::load(std::array{o.x, o.y, o.z, 0.0}.data())),
          to_float(FourDoubles::load(std::array{d.x, d.y, d.z, 0.0}.data())),
          FourFloats::load(stretch),
          !(std::min({stretch[0], stretch[1], stretch[2]}) > kLeastStretch &&
            std::max({stretch[0], stretch[1], stretch[2]}) < 1 / kLeastStretch)};
}

}  // namespace rays
}  // namespace HWY_NAMESPACE
}  // namespace mdk
HWY_AFTER_NAMESPACE();

#endif  // per-target guard
