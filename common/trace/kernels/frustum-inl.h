// A tile's frustum as eight linear forms, tested against boxes all at once. Compiled once per
// instruction set: no include guard in the usual sense, see tile_kernels.cpp.
//
// A form f(p) = n.p + w is negative where the frustum is not: four for the sides (at the outer
// edges of the tile's pixels, half a pixel past their centres), one for "nearer than the farthest
// hit so far", one for "in front of the eye". A box is outside if the largest value of one form
// over it is negative. Every w includes a slack that covers the rounding of this very test, so that
// no box that holds part of a hit triangle is ever dropped.
#include <algorithm>
#include <cmath>
#include <limits>

#include "common/trace/kernels/tile_kernels.h"

#if defined(MDK_FRUSTUM_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MDK_FRUSTUM_INL_H_
#undef MDK_FRUSTUM_INL_H_
#else
#define MDK_FRUSTUM_INL_H_
#endif

HWY_BEFORE_NAMESPACE();
namespace mdk {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

inline constexpr int kForms = 8;  // two are unused and always 0
inline constexpr int kNearForm = 4;
inline constexpr int kFrontForm = 5;

class TileFrustum {
 public:
  /// The frustum of `tile` in the basis `basis`, for boxes inside `bounds`.
  TileFrustum(const TileRays& tile, const FrustumBasis& basis, const Aabb& bounds) {
    for (std::size_t k = 0; k < 3; ++k)
      magnitude_[k] = std::max(std::abs(bounds.lo[k]), std::abs(bounds.hi[k]));
    const double side = basis.det < 0 ? -1.0 : 1.0;
    const double x0 = tile.x, x1 = x0 + kTileSide, y0 = tile.y, y1 = y0 + kTileSide;
    const double error = basis.plane_error;
    set_form(0, (basis.corner_x_dv + basis.du_x_dv * x0) * -side, basis.origin, error);
    set_form(1, (basis.corner_x_dv + basis.du_x_dv * x1) * side, basis.origin, error);
    set_form(2, (basis.du_x_corner + basis.du_x_dv * y0) * -side, basis.origin, error);
    set_form(3, (basis.du_x_corner + basis.du_x_dv * y1) * side, basis.origin, error);
    const Vec3d depth = basis.du_x_dv * (1.0 / basis.det);  // t of a point p is depth.(p - origin)
    set_form(kNearForm, -depth, basis.origin, basis.depth_error);
    set_form(kFrontForm, depth, basis.origin, basis.depth_error);
    near_offset_ = w_[kNearForm];
    for (std::size_t k = 0; k < 3; ++k) eye_[k] = basis.origin[k];
    set_farthest(std::numeric_limits<float>::infinity());
  }

  /// From now on boxes whose every point is farther than `t` are outside.
  void set_farthest(float t) { w_[kNearForm] = near_usable_ ? near_offset_ + t : 0.0f; }

  /// Whether the box is outside; false where in doubt.
  HWY_INLINE bool misses(const Vec3f& lo, const Vec3f& hi) const {
    const hn::CappedTag<float, kForms> d;
    for (std::size_t i = 0; i < kForms; i += hn::Lanes(d)) {
      // max over the box of n.p = sum over axes of max(n lo, n hi)
      const auto nx = hn::Load(d, nx_ + i), ny = hn::Load(d, ny_ + i), nz = hn::Load(d, nz_ + i);
      const auto x = hn::Max(hn::Mul(nx, hn::Set(d, lo.x)), hn::Mul(nx, hn::Set(d, hi.x)));
      const auto y = hn::Max(hn::Mul(ny, hn::Set(d, lo.y)), hn::Mul(ny, hn::Set(d, hi.y)));
      const auto z = hn::Max(hn::Mul(nz, hn::Set(d, lo.z)), hn::Mul(nz, hn::Set(d, hi.z)));
      const auto value = hn::Add(hn::Add(x, y), hn::Add(z, hn::Load(d, w_ + i)));
      if (!hn::AllFalse(d, hn::Lt(value, hn::Zero(d)))) return true;
    }
    return false;
  }

  /// Whether rays of the tile meet the cell below a split plane before the one above it.
  bool below_first(std::uint32_t axis, float split) const { return eye_[axis] <= split; }

  /// Depth along the rays of a point, up to a constant: orders boxes front to back.
  float depth_order(const Vec3f& p) const {
    return nx_[kFrontForm] * p.x + ny_[kFrontForm] * p.y + nz_[kFrontForm] * p.z;
  }

 private:
  void set_form(int form, const Vec3d& n, const Vec3d& through, double n_error) {
    // In float, n, the products, the sums and w lose about 6 x 2^-24 in all, and the triangle
    // test's own view of the corners (offset from the eye, pixel space) as much again: 2^-20 holds
    // both.
    double slack = 0;
    for (std::size_t k = 0; k < 3; ++k)
      slack += (std::abs(n[k]) * 0x1p-20 + n_error) * (magnitude_[k] + std::abs(through[k]));
    const double w = -dot(n, through) + slack;
    const double largest = std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z), std::abs(w)});
    const bool usable = largest < 1e30;  // a basis near singular: such a form tells nothing
    nx_[form] = usable ? static_cast<float>(n.x) : 0.0f;
    ny_[form] = usable ? static_cast<float>(n.y) : 0.0f;
    nz_[form] = usable ? static_cast<float>(n.z) : 0.0f;
    w_[form] = usable ? static_cast<float>(w) : 0.0f;
    if (form == kNearForm) near_usable_ = usable;
  }

  alignas(64) float nx_[kForms] = {}, ny_[kForms] = {}, nz_[kForms] = {}, w_[kForms] = {};
  double magnitude_[3];
  double eye_[3];
  float near_offset_ = 0;
  bool near_usable_ = true;
};

}  // namespace HWY_NAMESPACE
}  // namespace mdk
HWY_AFTER_NAMESPACE();

#endif  // per-target guard
