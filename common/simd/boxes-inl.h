// Boxes against what rays share: linear forms, whose largest value over a box stands at one corner,
// and the slabs between a box's planes. Boxes of a node's children stand side by side, a row of
// eight numbers for each of their six planes, so that a vector tests all of them.
//
//      lo.y +-------+ n            far corner of a box: per axis hi where n >= 0, else lo;
//           |       |  \           n_x far.x + n_y far.y + n_z far.z + w < 0: box outside.
//           +-------+   form
#include "common/math/aabb.h"
#include "common/simd/lanes-inl.h"

#if defined(MDK_BOXES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MDK_BOXES_INL_H_
#undef MDK_BOXES_INL_H_
#else
#define MDK_BOXES_INL_H_
#endif

HWY_BEFORE_NAMESPACE();
namespace mdk {
namespace HWY_NAMESPACE {

/// Forms f(p) = n.p + w: a box is outside if a form is negative all over it.
template <std::size_t kForms>
class BoxForms {
 public:
  /// A box of a kd-tree, and what each axis adds to the forms' largest values over it: a child
  /// differs from its parent in one axis.
  struct Cell {
    std::uint32_t node;
    float lo[3], hi[3];
    alignas(kForms * sizeof(float)) float largest[3][kForms];
  };

  /// nx, ny, nz or w of all forms.
  float* row(std::size_t r) { return value_[r]; }
  const float* row(std::size_t r) const { return value_[r]; }

  /// To be called once the normals are set.
  void choose_corners() {
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (std::size_t k = 0; k < kForms; ++k)
        far_plane_[axis][k] = static_cast<std::uint8_t>(2 * axis + (value_[axis][k] >= 0));
  }

  /// The largest value of form `k` over boxes `first`... of a node. Fused: it only culls.
  template <class D, std::size_t kWidth>
  HWY_INLINE hn::Vec<D> largest(D d, const float (&planes)[6][kWidth], std::size_t first,
                                std::size_t k) const {
    const auto far = [&](std::size_t axis) {
      return hn::Load(d, planes[far_plane_[axis][k]] + first);
    };
    const auto z = hn::MulAdd(hn::Set(d, value_[2][k]), far(2), hn::Set(d, value_[3][k]));
    const auto yz = hn::MulAdd(hn::Set(d, value_[1][k]), far(1), z);
    return hn::MulAdd(hn::Set(d, value_[0][k]), far(0), yz);
  }

  HWY_INLINE void set_axis(Cell& cell, std::size_t axis, float lo, float hi) const {
    const hn::CappedTag<float, kForms> d;
    cell.lo[axis] = lo;
    cell.hi[axis] = hi;
    for (std::size_t k = 0; k < kForms; k += hn::Lanes(d)) {
      const auto n = hn::Load(d, value_[axis] + k);
      hn::Store(hn::Max(hn::Mul(n, hn::Set(d, lo)), hn::Mul(n, hn::Set(d, hi))), d,
                cell.largest[axis] + k);
    }
  }

  HWY_INLINE bool is_outside(const Cell& cell) const {
    const hn::CappedTag<float, kForms> d;
    for (std::size_t k = 0; k < kForms; k += hn::Lanes(d)) {
      const auto xy = hn::Add(hn::Load(d, cell.largest[0] + k), hn::Load(d, cell.largest[1] + k));
      const auto zw = hn::Add(hn::Load(d, cell.largest[2] + k), hn::Load(d, value_[3] + k));
      if (!hn::AllFalse(d, hn::Lt(hn::Add(xy, zw), hn::Zero(d)))) return true;
    }
    return false;
  }

 private:
  alignas(64) float value_[4][kForms];
  std::uint8_t far_plane_[3][kForms];
};

/// Where a ray is inside the slabs of as many boxes as a vector has lanes.
template <class D>
struct Slabs {
  hn::Vec<D> near, far;

  Slabs(D d, float t_begin, float t_max) : near(hn::Set(d, t_begin)), far(hn::Set(d, t_max)) {}

  /// `Ray` has an origin for low sides, one for high sides, and the direction's inverse.
  template <class Ray>
  HWY_INLINE void cut(D d, const Ray& ray, std::size_t axis, hn::Vec<D> low_side,
                      hn::Vec<D> high_side) {
    const auto inverse = hn::Set(d, ray.inverse[axis]);
    const auto low = hn::Mul(hn::Sub(low_side, hn::Set(d, ray.origin_for_low[axis])), inverse);
    const auto high = hn::Mul(hn::Sub(high_side, hn::Set(d, ray.origin_for_high[axis])), inverse);
    near = hn::Max(near, hn::Min(low, high));
    far = hn::Min(far, hn::Max(low, high));
  }
  HWY_INLINE std::uint32_t entered(D d) const { return mask_bits(d, hn::Le(near, far)); }
};

}  // namespace HWY_NAMESPACE
}  // namespace mdk
HWY_AFTER_NAMESPACE();

#endif  // per-target guard
