// From a block of triangles in the world to its forms over the image, one triangle a lane.
//
// With p = (x, y, z) of a corner in pixel space (image point x/z, y/z at depth z):
//
//     e_ab = (b - a) x (b + a)          twice b x a, exact under exchange: e_ba = -e_ab
//     E_ab(X, Y) = e_ab . (X, Y, 1)     which side of edge ab the ray passes
//     N = (b - a) x (c - a),  1/t = (N / N.a) . (X, Y, 1)
#include <limits>

#include "common/simd/lanes-inl.h"
#include "common/trace/kernels/tile_kernels.h"

#if defined(MDK_PROJECTION_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MDK_PROJECTION_INL_H_
#undef MDK_PROJECTION_INL_H_
#else
#define MDK_PROJECTION_INL_H_
#endif

HWY_BEFORE_NAMESPACE();
namespace mdk {
namespace HWY_NAMESPACE {
namespace tiles {

static_assert(hn::MaxLanes(FloatTag()) <= kBlockTriangles);
using Points = HWY_NAMESPACE::Points<FloatTag>;

/// Nearer corners count as behind the eye: their inverse depth might not be finite.
inline constexpr float kMinDepth = 1e-30f;

/// The corners of triangles `first`... of a block, in pixel space.
struct Corners {
  Points a, b, c;
};

HWY_INLINE Points to_pixel_space(const PixelFromWorld& map, const Points& world) {
  const FloatTag d;
  const Points p = world - broadcast(d, map.origin);
  const auto row = [&](const float* m) { return dot(broadcast(d, Vec3f{m[0], m[1], m[2]}), p); };
  return {row(map.m[0]), row(map.m[1]), row(map.m[2])};
}

HWY_INLINE Corners gather_corners(const TriangleBlock& block, std::size_t first,
                                  const PixelFromWorld& map, const Vec3f* positions) {
  const FloatTag d;
  return {to_pixel_space(map, gather(d, block.corner[0] + first, positions)),
          to_pixel_space(map, gather(d, block.corner[1] + first, positions)),
          to_pixel_space(map, gather(d, block.corner[2] + first, positions))};
}

/// The corners of a block by their numbers among positions.
struct IndexedCorners {
  const TriangleBlock& block;
  const PixelFromWorld& map;
  const Vec3f* positions;

  HWY_INLINE Corners operator()(std::size_t first) const {
    return gather_corners(block, first, map, positions);
  }
};

/// Fills a ProjectedBlock of `count` triangles, a vector at a time: `corners(first)` gives those of
/// triangles `first`...
template <class CornerSource>
class Projector {
 public:
  /// `margin`: how far outside the corners' image bounds a hit may be (PixelFromWorld).
  Projector(std::uint32_t count, const CornerSource& corners, float margin, ProjectedBlock& out)
      : count_(count), corners_(corners), margin_(margin), out_(out) {}

  /// Looks at `wanted(first)`, the mask of lanes that matter given the bounds now stored for them,
  /// before it computes any form: lanes it leaves out are not live.
  template <class Wanted>
  HWY_INLINE void run(const Wanted& wanted) {
    const FloatTag d;
    out_.live = out_.behind = out_.small = 0;
    for (std::size_t i = 0; i < count_; i += hn::Lanes(d)) {
      const Corners corners = corners_(i);
      const FloatMask seen = set_bounds(corners, i);
      const FloatMask some = hn::And(seen, wanted(i));
      if (hn::AllFalse(d, some)) continue;
      const FloatMask sound = set_forms(corners, i);
      out_.live |= mask_bits(d, hn::And(some, sound)) << i;
    }
    out_.live &= (1u << count_) - 1;
  }

 private:
  /// False where no pixel centre is within the bounds, or all is behind the eye.
  HWY_INLINE FloatMask set_bounds(const Corners& p, std::size_t i) {
    const FloatTag d;
    const auto zero = hn::Zero(d), one = hn::Set(d, 1.0f);
    const auto infinite = hn::Set(d, std::numeric_limits<float>::infinity());
    const auto nearest = hn::Min(hn::Min(p.a.z, p.b.z), p.c.z);
    const auto deepest = hn::Max(hn::Max(p.a.z, p.b.z), p.c.z);
    const auto in_front = hn::Gt(nearest, hn::Set(d, kMinDepth));
    const auto ra = hn::Div(one, p.a.z), rb = hn::Div(one, p.b.z), rc = hn::Div(one, p.c.z);
    const auto min = hn::Min(hn::Min(ra, rb), rc), max = hn::Max(hn::Max(ra, rb), rc);
    hn::Store(hn::IfThenElse(in_front, min, hn::Div(one, deepest)), d, out_.min_inverse_depth + i);
    hn::Store(hn::IfThenElse(in_front, max, infinite), d, out_.max_inverse_depth + i);

    const auto span = [&](FloatVec a, FloatVec b, FloatVec c, float* first, float* last) {
      const auto u = hn::Mul(a, ra), v = hn::Mul(b, rb), w = hn::Mul(c, rc);
      const auto half = hn::Set(d, 0.5f);
      const auto lo =
          hn::Add(hn::Ceil(hn::Sub(hn::Min(hn::Min(u, v), w), hn::Set(d, 0.5f + margin_))), half);
      const auto hi =
          hn::Add(hn::Floor(hn::Sub(hn::Max(hn::Max(u, v), w), hn::Set(d, 0.5f - margin_))), half);
      hn::Store(hn::IfThenElse(in_front, lo, hn::Neg(infinite)), d, first + i);
      hn::Store(hn::IfThenElse(in_front, hi, infinite), d, last + i);
      return hn::Sub(hi, lo);
    };
    const auto wide = span(p.a.x, p.b.x, p.c.x, out_.first_x, out_.last_x);
    const auto high = span(p.a.y, p.b.y, p.c.y, out_.first_y, out_.last_y);
    out_.small |= mask_bits(d, hn::And(in_front, hn::Le(hn::Max(wide, high), one))) << i;
    out_.behind |= mask_bits(d, hn::Not(in_front)) << i;
    const auto some = hn::Ge(hn::Min(wide, high), zero);
    return hn::And(hn::Gt(deepest, zero), hn::Or(some, hn::Not(in_front)));
  }

  /// False where a form is not finite, or so large that its values might not be.
  HWY_INLINE FloatMask set_forms(const Corners& p, std::size_t i) {
    const FloatTag d;
    const Points edges[3] = {edge_form(p.a, p.b), edge_form(p.b, p.c), edge_form(p.c, p.a)};
    const Points normal = cross(p.b - p.a, p.c - p.a);
    const Points inverse_depth = scaled(normal, hn::Div(hn::Set(d, 1.0f), dot(normal, p.a)));
    auto sum = sum_of_sizes(inverse_depth);
    for (int k = 0; k < 3; ++k) {
      put(edges[k], out_.edge[k], i);
      sum = hn::Add(sum, sum_of_sizes(edges[k]));
    }
    put(inverse_depth, out_.inverse_depth, i);
    return hn::Lt(sum, hn::Set(d, 1e30f));
  }

  static HWY_INLINE void put(const Points& p, ImageForms& forms, std::size_t i) {
    store(FloatTag(), p, forms.x + i, forms.y + i, forms.z + i);
  }

  const std::uint32_t count_;
  const CornerSource& corners_;
  const float margin_;
  ProjectedBlock& out_;
};

}  // namespace tiles
}  // namespace HWY_NAMESPACE
}  // namespace mdk
HWY_AFTER_NAMESPACE();

#endif  // per-target guard
