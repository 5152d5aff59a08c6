// From a block of triangles in the world to its forms over the image, one triangle a lane.
//
// With p = (x, y, z) of a corner in pixel space (image point x/z, y/z at depth z):
//
//     e_ab = (b - a) x (b + a)          twice b x a, exact under exchange: e_ba = -e_ab
//     E_ab(X, Y) = e_ab . (X, Y, 1)     which side of edge ab the ray passes
//     N = (b - a) x (c - a),  1/t = (N / N.a) . (X, Y, 1)
#include <limits>

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
namespace hn = hwy::HWY_NAMESPACE;

using FloatTag = hn::CappedTag<float, kBlockTriangles>;
using FloatVec = hn::Vec<FloatTag>;
using FloatMask = hn::Mask<FloatTag>;

/// x, y, z of one point per lane.
struct Points {
  FloatVec x, y, z;
};

HWY_INLINE Points subtract(const Points& a, const Points& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE Points add(const Points& a, const Points& b) {
  return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}
HWY_INLINE Points cross_product(const Points& a, const Points& b) {
  return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)),
          hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
          hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x))};
}
HWY_INLINE FloatVec dot_product(const Points& a, const Points& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
HWY_INLINE Points edge_form(const Points& a, const Points& b) {
  return cross_product(subtract(b, a), add(b, a));
}

/// The mask's bits, lane 0 lowest.
HWY_INLINE std::uint32_t bits_of(FloatMask mask) {
  const FloatTag d;
  alignas(8) std::uint8_t bits[8] = {};
  hn::StoreMaskBits(d, mask, bits);
  const std::uint32_t all = bits[0] | static_cast<std::uint32_t>(bits[1]) << 8;
  return all & ((1u << hn::Lanes(d)) - 1);
}

/// Nearer corners count as behind the eye: their nearness might not be finite.
inline constexpr float kLeastDepth = 1e-30f;

/// The corners of triangles `first`... of a block, in pixel space.
struct Corners {
  Points a, b, c;
};

HWY_INLINE Points gather_points(const std::uint32_t* vertices, const Vec3f* positions) {
  const FloatTag d;
  const hn::RebindToSigned<FloatTag> di;
  static_assert(sizeof(Vec3f) == 3 * sizeof(float));
  const auto v = hn::BitCast(di, hn::Load(hn::RebindToUnsigned<FloatTag>(), vertices));
  const auto index = hn::Add(v, hn::Add(v, v));
  const float* base = &positions->x;
  return {hn::GatherIndex(d, base, index), hn::GatherIndex(d, base + 1, index),
          hn::GatherIndex(d, base + 2, index)};
}

HWY_INLINE Points to_pixel_space(const PixelFromWorld& map, const Points& world) {
  const FloatTag d;
  const Points p{hn::Sub(world.x, hn::Set(d, map.origin.x)),
                 hn::Sub(world.y, hn::Set(d, map.origin.y)),
                 hn::Sub(world.z, hn::Set(d, map.origin.z))};
  const auto row = [&](const float* m) {
    return dot_product({hn::Set(d, m[0]), hn::Set(d, m[1]), hn::Set(d, m[2])}, p);
  };
  return {row(map.m[0]), row(map.m[1]), row(map.m[2])};
}

HWY_INLINE Corners gather_corners(const TriangleBlock& block, std::size_t first,
                                  const PixelFromWorld& map, const Vec3f* positions) {
  return {to_pixel_space(map, gather_points(block.corner[0] + first, positions)),
          to_pixel_space(map, gather_points(block.corner[1] + first, positions)),
          to_pixel_space(map, gather_points(block.corner[2] + first, positions))};
}

/// Fills a ProjectedBlock, a vector of triangles at a time.
class Projector {
 public:
  Projector(const TriangleBlock& block, const PixelFromWorld& map, const Vec3f* positions,
            ProjectedBlock& out)
      : block_(block), map_(map), positions_(positions), out_(out) {}

  /// Looks at `wanted(first)`, the mask of lanes that matter given the bounds now stored for them,
  /// before it computes any form: lanes it leaves out are not live.
  template <class Wanted>
  HWY_INLINE void run(const Wanted& wanted) {
    const FloatTag d;
    out_.live = out_.behind = out_.small = 0;
    for (std::size_t i = 0; i < block_.count; i += hn::Lanes(d)) {
      const Corners corners = gather_corners(block_, i, map_, positions_);
      const FloatMask seen = set_bounds(corners, i);
      const FloatMask some = hn::And(seen, wanted(i));
      if (hn::AllFalse(d, some)) continue;
      const FloatMask sound = set_forms(corners, i);
      out_.live |= bits_of(hn::And(some, sound)) << i;
    }
    out_.live &= (1u << block_.count) - 1;
  }

 private:
  /// False where no pixel centre is within the bounds, or all is behind the eye.
  HWY_INLINE FloatMask set_bounds(const Corners& p, std::size_t i) {
    const FloatTag d;
    const auto zero = hn::Zero(d), one = hn::Set(d, 1.0f);
    const auto infinite = hn::Set(d, std::numeric_limits<float>::infinity());
    const auto nearest = hn::Min(hn::Min(p.a.z, p.b.z), p.c.z);
    const auto deepest = hn::Max(hn::Max(p.a.z, p.b.z), p.c.z);
    const auto in_front = hn::Gt(nearest, hn::Set(d, kLeastDepth));
    const auto ra = hn::Div(one, p.a.z), rb = hn::Div(one, p.b.z), rc = hn::Div(one, p.c.z);
    const auto least = hn::Min(hn::Min(ra, rb), rc), most = hn::Max(hn::Max(ra, rb), rc);
    hn::Store(hn::IfThenElse(in_front, least, hn::Div(one, deepest)), d, out_.least_nearness + i);
    hn::Store(hn::IfThenElse(in_front, most, infinite), d, out_.most_nearness + i);

    const auto span = [&](FloatVec a, FloatVec b, FloatVec c, float* first, float* last) {
      const auto u = hn::Mul(a, ra), v = hn::Mul(b, rb), w = hn::Mul(c, rc);
      const auto half = hn::Set(d, 0.5f);
      const auto lo =
          hn::Add(hn::Ceil(hn::Sub(hn::Min(hn::Min(u, v), w), hn::Set(d, 0.75f))), half);
      const auto hi =
          hn::Add(hn::Floor(hn::Sub(hn::Max(hn::Max(u, v), w), hn::Set(d, 0.25f))), half);
      hn::Store(hn::IfThenElse(in_front, lo, hn::Neg(infinite)), d, first + i);
      hn::Store(hn::IfThenElse(in_front, hi, infinite), d, last + i);
      return hn::Sub(hi, lo);
    };
    const auto wide = span(p.a.x, p.b.x, p.c.x, out_.first_x, out_.last_x);
    const auto high = span(p.a.y, p.b.y, p.c.y, out_.first_y, out_.last_y);
    out_.small |= bits_of(hn::And(in_front, hn::Le(hn::Max(wide, high), one))) << i;
    out_.behind |= bits_of(hn::Not(in_front)) << i;
    const auto some = hn::Ge(hn::Min(wide, high), zero);
    return hn::And(hn::Gt(deepest, zero), hn::Or(some, hn::Not(in_front)));
  }

  /// False where a form is not finite, or so large that its values might not be.
  HWY_INLINE FloatMask set_forms(const Corners& p, std::size_t i) {
    const FloatTag d;
    const Points edges[3] = {edge_form(p.a, p.b), edge_form(p.b, p.c), edge_form(p.c, p.a)};
    const Points normal = cross_product(subtract(p.b, p.a), subtract(p.c, p.a));
    const auto inverse = hn::Div(hn::Set(d, 1.0f), dot_product(normal, p.a));
    const Points nearness{hn::Mul(normal.x, inverse), hn::Mul(normal.y, inverse),
                          hn::Mul(normal.z, inverse)};
    const auto size = [](const Points& q) {
      return hn::Add(hn::Add(hn::Abs(q.x), hn::Abs(q.y)), hn::Abs(q.z));
    };
    auto sum = size(nearness);
    for (int k = 0; k < 3; ++k) {
      store(edges[k], out_.edge[k], i);
      sum = hn::Add(sum, size(edges[k]));
    }
    store(nearness, out_.nearness, i);
    return hn::Lt(sum, hn::Set(d, 1e30f));
  }

  static HWY_INLINE void store(const Points& p, ImageForms& forms, std::size_t i) {
    const FloatTag d;
    hn::Store(p.x, d, forms.x + i);
    hn::Store(p.y, d, forms.y + i);
    hn::Store(p.z, d, forms.z + i);
  }

  const TriangleBlock& block_;
  const PixelFromWorld& map_;
  const Vec3f* positions_;
  ProjectedBlock& out_;
};

}  // namespace HWY_NAMESPACE
}  // namespace mdk
HWY_AFTER_NAMESPACE();

#endif  // per-target guard
