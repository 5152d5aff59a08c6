// The one triangle test of the project: every technique, brute force included, ends here, so every
// technique finds the same hits to the bit.
//
// All rays of a picture start at one point, so a triangle is three edge functions over the image.
// With p = (x, y, z) of a vertex in pixel space (image point x/z, y/z at depth z):
//
//     e_ab = (b - a) x (b + a)          twice b x a, exact under exchange: e_ba = -e_ab
//     E_ab(X, Y) = e_ab . (X, Y, 1)     which side of edge ab the ray passes
//
//          c           hit where the three have one sign (zero counts as both: shared edges
//         / \          leave no gap);
//        / + \         depth t = N.a / N.(X, Y, 1) with N = (b - a) x (c - a),
//       a-----b        clamped to the depths of the corners.
//
// A hit must also lie within a quarter pixel of the corners' image bounds; where the triangle
// reaches behind the eye and has none, one of its corners must be on the inner side of each of the
// tile's planes. For triangles of sane shape these clauses change nothing; for slivers, whose edge
// functions are all rounding, they keep the hit inside what any box around the triangle shows,
// which is what makes structures exact. Multiplications and additions are rounded apart (no fused
// ones): the same hits on every machine.
#include <limits>

#include "common/trace/kernels/tile_kernels.h"

#if defined(MDK_TRIANGLE_BATCH_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MDK_TRIANGLE_BATCH_INL_H_
#undef MDK_TRIANGLE_BATCH_INL_H_
#else
#define MDK_TRIANGLE_BATCH_INL_H_
#endif

HWY_BEFORE_NAMESPACE();
namespace mdk {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using FloatTag = hn::CappedTag<float, 16>;
using FloatVec = hn::Vec<FloatTag>;
inline constexpr std::size_t kMaxBatch = 16;

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

/// A linear form over the image, one per triangle of a batch: x X + (y Y + z).
struct alignas(64) ImageForms {
  float x[kMaxBatch], y[kMaxBatch], z[kMaxBatch];
};

/// Collects candidate triangles of one tile and tests them a vector at a time.
class TriangleBatch {
 public:
  TriangleBatch(const TileRays& tile, const TriangleSoup& soup, TileHits& hits,
                TraceCounters* counters)
      : tile_(tile), soup_(soup), hits_(hits), counters_(counters) {}

  /// Depth of the farthest hit of the tile; infinite while a ray has none.
  float farthest() const { return farthest_; }

  void push(std::uint32_t triangle) {
    ids_[size_++] = triangle;
    if (size_ == hn::Lanes(FloatTag())) flush();
  }

  void flush() {
    if (size_ == 0) return;
    if (counters_ != nullptr) counters_->triangle_setups += size_;
    std::uint32_t survivors = setup();
    bool found = false;
    for (; survivors != 0; survivors &= survivors - 1)
      found |= test_pixels(static_cast<std::size_t>(__builtin_ctz(survivors)));
    if (found) update_farthest();
    size_ = 0;
  }

 private:
  /// Gathers the corners, computes all forms, and drops triangles that miss the whole tile.
  std::uint32_t setup() {
    const FloatTag d;
    alignas(64) float corner[3][3][kMaxBatch];
    for (std::size_t i = 0; i < hn::Lanes(d); ++i) {
      const Triangle& triangle = soup_.triangles[ids_[i < size_ ? i : 0]];
      for (int k = 0; k < 3; ++k) {
        const Vec3f& v = soup_.positions[triangle.v[k]];
        corner[k][0][i] = v.x;
        corner[k][1][i] = v.y;
        corner[k][2][i] = v.z;
      }
    }
    const Points a = to_pixel_space(corner[0]), b = to_pixel_space(corner[1]),
                 c = to_pixel_space(corner[2]);
    store(edges_[0], edge_form(a, b));
    store(edges_[1], edge_form(b, c));
    store(edges_[2], edge_form(c, a));
    const Points normal = cross_product(subtract(b, a), subtract(c, a));
    store(normal_, normal);
    hn::Store(dot_product(normal, a), d, numerator_);
    const auto nearest = hn::Min(hn::Min(a.z, b.z), c.z), deepest = hn::Max(hn::Max(a.z, b.z), c.z);
    hn::Store(nearest, d, nearest_);
    hn::Store(deepest, d, deepest_);

    const auto behind = hn::Le(deepest, hn::Zero(d));
    const auto hidden = hn::Gt(nearest, hn::Set(d, farthest_));
    const auto missed =
        hn::Or(hn::Or(behind, hidden), hn::Or(misses_bounds(a, b, c, nearest), misses_edges()));
    alignas(64) std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, hn::Not(missed), bits);
    const std::uint32_t alive = bits[0] | static_cast<std::uint32_t>(bits[1]) << 8;
    return alive & ((1u << size_) - 1);
  }

  HWY_INLINE Points to_pixel_space(const float (&world)[3][kMaxBatch]) const {
    const FloatTag d;
    const PixelFromWorld& map = *tile_.pixel_from_world;
    const Points p{hn::Sub(hn::Load(d, world[0]), hn::Set(d, map.origin.x)),
                   hn::Sub(hn::Load(d, world[1]), hn::Set(d, map.origin.y)),
                   hn::Sub(hn::Load(d, world[2]), hn::Set(d, map.origin.z))};
    const auto row = [&](const float* m) {
      return dot_product({hn::Set(d, m[0]), hn::Set(d, m[1]), hn::Set(d, m[2])}, p);
    };
    return {row(map.m[0]), row(map.m[1]), row(map.m[2])};
  }

  static HWY_INLINE void store(ImageForms& forms, const Points& p) {
    const FloatTag d;
    hn::Store(p.x, d, forms.x);
    hn::Store(p.y, d, forms.y);
    hn::Store(p.z, d, forms.z);
  }

  /// Image bounds of each triangle, a quarter pixel wider; all of the image where it reaches behind
  /// the eye. True where they hold no pixel centre of the tile.
  HWY_INLINE hn::Mask<FloatTag> misses_bounds(const Points& a, const Points& b, const Points& c,
                                              FloatVec nearest) {
    const FloatTag d;
    const auto in_front = hn::Gt(nearest, hn::Zero(d));
    const auto infinite = hn::Set(d, std::numeric_limits<float>::infinity());
    const auto margin = hn::Set(d, 0.25f);
    const auto bound = [&](FloatVec p, FloatVec q, FloatVec r, float* low, float* high) {
      const auto lo = hn::Sub(hn::Min(hn::Min(p, q), r), margin);
      const auto hi = hn::Add(hn::Max(hn::Max(p, q), r), margin);
      hn::Store(hn::IfThenElse(in_front, lo, hn::Neg(infinite)), d, low);
      hn::Store(hn::IfThenElse(in_front, hi, infinite), d, high);
    };
    bound(hn::Div(a.x, a.z), hn::Div(b.x, b.z), hn::Div(c.x, c.z), low_x_, high_x_);
    bound(hn::Div(a.y, a.z), hn::Div(b.y, b.z), hn::Div(c.y, c.z), low_y_, high_y_);
    const auto outside = [&](const float* low, const float* high, std::uint32_t first) {
      const float begin = static_cast<float>(first) + 0.5f;
      return hn::Or(hn::Lt(hn::Load(d, high), hn::Set(d, begin)),
                    hn::Gt(hn::Load(d, low), hn::Set(d, begin + (kTileSide - 1))));
    };
    const auto missed =
        hn::Or(outside(low_x_, high_x_, tile_.x), outside(low_y_, high_y_, tile_.y));
    if (hn::AllTrue(d, in_front)) return missed;
    return hn::Or(missed, misses_sides(a, b, c));
  }

  /// True where all corners are on the outer side of one of the tile's four planes.
  HWY_INLINE hn::Mask<FloatTag> misses_sides(const Points& a, const Points& b,
                                             const Points& c) const {
    const FloatTag d;
    const auto one_side = [&](FloatVec p, FloatVec q, FloatVec r, std::uint32_t first) {
      const auto offset = [&](FloatVec coordinate, FloatVec depth, std::uint32_t edge) {
        return hn::Sub(coordinate, hn::Mul(depth, hn::Set(d, static_cast<float>(edge))));
      };
      const auto below =
          hn::Max(hn::Max(offset(p, a.z, first), offset(q, b.z, first)), offset(r, c.z, first));
      const std::uint32_t last = first + kTileSide;
      const auto above =
          hn::Min(hn::Min(offset(p, a.z, last), offset(q, b.z, last)), offset(r, c.z, last));
      return hn::Or(hn::Lt(below, hn::Zero(d)), hn::Gt(above, hn::Zero(d)));
    };
    return hn::Or(one_side(a.x, b.x, c.x, tile_.x), one_side(a.y, b.y, c.y, tile_.y));
  }

  /// True where some edge has all pixel centres of the tile strictly on its outer side, for both
  /// windings. Exact: a form rounds monotonically in X and in Y, so its extremes over the tile are
  /// those at the corner pixels, computed just as test_pixels() does.
  HWY_INLINE hn::Mask<FloatTag> misses_edges() const {
    const FloatTag d;
    const float x0 = static_cast<float>(tile_.x) + 0.5f, x1 = x0 + (kTileSide - 1);
    const float y0 = static_cast<float>(tile_.y) + 0.5f, y1 = y0 + (kTileSide - 1);
    auto some_below = hn::Lt(hn::Zero(d), hn::Zero(d));
    auto some_above = some_below;
    for (const ImageForms& e : edges_) {
      const auto x = hn::Load(d, e.x), y = hn::Load(d, e.y), z = hn::Load(d, e.z);
      const auto top = hn::Add(hn::Mul(y, hn::Set(d, y0)), z);
      const auto bottom = hn::Add(hn::Mul(y, hn::Set(d, y1)), z);
      const auto left = hn::Mul(x, hn::Set(d, x0)), right = hn::Mul(x, hn::Set(d, x1));
      const auto high = hn::Add(hn::Max(left, right), hn::Max(top, bottom));
      const auto low = hn::Add(hn::Min(left, right), hn::Min(top, bottom));
      some_below = hn::Or(some_below, hn::Lt(high, hn::Zero(d)));
      some_above = hn::Or(some_above, hn::Gt(low, hn::Zero(d)));
    }
    return hn::And(some_below, some_above);
  }

  /// Tests triangle `i` of the batch against every pixel of the tile, a row at a time.
  bool test_pixels(std::size_t i) {
    const FloatTag d;
    const std::size_t lanes = hn::Lanes(d);
    bool found = false;
    for (std::uint32_t j = 0; j < kTileSide; ++j) {
      const float y = static_cast<float>(tile_.y + j) + 0.5f;
      if (y < low_y_[i] || y > high_y_[i]) continue;
      if (counters_ != nullptr) counters_->triangle_tests += kTileSide;
      for (std::size_t x = 0; x < kTileSide; x += lanes) found |= test_row(i, j, x, y);
    }
    return found;
  }

  HWY_INLINE bool test_row(std::size_t i, std::uint32_t j, std::size_t first, float y) {
    const FloatTag d;
    const auto x = hn::Add(hn::Iota(d, static_cast<float>(tile_.x + first)), hn::Set(d, 0.5f));
    const auto value = [&](const ImageForms& form) {
      return hn::Add(hn::Mul(hn::Set(d, form.x[i]), x), hn::Set(d, form.y[i] * y + form.z[i]));
    };
    const auto e0 = value(edges_[0]), e1 = value(edges_[1]), e2 = value(edges_[2]);
    const auto zero = hn::Zero(d);
    const auto front = hn::Ge(hn::Min(hn::Min(e0, e1), e2), zero);
    const auto back = hn::Le(hn::Max(hn::Max(e0, e1), e2), zero);
    const auto inside = hn::Or(front, back);
    if (hn::AllFalse(d, inside)) return false;

    const auto denominator = value(normal_);
    auto t = hn::Div(hn::Set(d, numerator_[i]), denominator);
    t = hn::Min(hn::Max(t, hn::Set(d, nearest_[i])), hn::Set(d, deepest_[i]));
    const auto within =
        hn::And(hn::Ge(x, hn::Set(d, low_x_[i])), hn::Le(x, hn::Set(d, high_x_[i])));
    // Written so that a corner that is not a number fails it.
    const auto real = hn::And(hn::Gt(hn::Abs(denominator), zero), hn::Gt(t, zero));

    const hn::RebindToUnsigned<FloatTag> du;
    float* best_t = hits_.t + j * kTileSide + first;
    std::uint32_t* best_id = hits_.triangle + j * kTileSide + first;
    const auto old_t = hn::Load(d, best_t);
    const auto old_id = hn::Load(du, best_id);
    const auto id = hn::Set(du, ids_[i]);
    const auto tie = hn::And(hn::Eq(t, old_t), hn::RebindMask(d, hn::Lt(id, old_id)));
    const auto closer = hn::Or(hn::Lt(t, old_t), tie);
    const auto hit = hn::And(hn::And(inside, within), hn::And(real, closer));
    if (hn::AllFalse(d, hit)) return false;
    hn::Store(hn::IfThenElse(hit, t, old_t), d, best_t);
    hn::Store(hn::IfThenElse(hn::RebindMask(du, hit), id, old_id), du, best_id);
    return true;
  }

  void update_farthest() {
    const FloatTag d;
    auto farthest = hn::Load(d, hits_.t);
    for (std::size_t i = hn::Lanes(d); i < kTilePixels; i += hn::Lanes(d))
      farthest = hn::Max(farthest, hn::Load(d, hits_.t + i));
    farthest_ = hn::GetLane(hn::MaxOfLanes(d, farthest));
  }

  const TileRays& tile_;
  const TriangleSoup& soup_;
  TileHits& hits_;
  TraceCounters* counters_;
  float farthest_ = std::numeric_limits<float>::infinity();
  std::size_t size_ = 0;
  std::uint32_t ids_[kMaxBatch];
  ImageForms edges_[3], normal_;
  alignas(64) float numerator_[kMaxBatch];
  alignas(64) float nearest_[kMaxBatch], deepest_[kMaxBatch];
  alignas(64) float low_x_[kMaxBatch], high_x_[kMaxBatch];
  alignas(64) float low_y_[kMaxBatch], high_y_[kMaxBatch];
};

}  // namespace HWY_NAMESPACE
}  // namespace mdk
HWY_AFTER_NAMESPACE();

#endif  // per-target guard
