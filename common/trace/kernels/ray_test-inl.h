// Triangles against single rays: the test in double that decides, and the one in float before it. With corners a, b, c seen from the ray's origin, the
// weight of c at the direction d is ((b - a) x (b + a)) . d, exactly negated when a and b change
// places: two triangles that share an edge agree on which side the ray passes.
//
//     hit where the three weights have one sign, each give or take its rounding: also a ray that
//     passes a vertex exactly, where all signs are rounding, hits one of the triangles around it
//     p = (w_a a + w_b b + w_c c) / (w_a + w_b + w_c)      weights of the wrong sign count as 0, so
//                                                          p is on the triangle in any case
//     t = p.d / d.d                                        and p must lie close to the ray
//
// The last clause does nothing for triangles of sane shape. For slivers, whose weights are all
// rounding, it keeps hits where any box around the triangle shows them.
//
// In float, triangles are rejected before that. With the ray along an axis of the image (x, y), the
// origin at (0, 0), an edge's weight is a_x b_y - a_y b_x. Let g be no less than the distance of any
// point of the model from the origin, m the largest |x|, |y| of the corners. A hit has a point of the
// triangle within 2^-20 g of the ray, so within sqrt(2) 2^-20 g of (0, 0) along x and along y, which
// moves a weight by 1.42 * 2^-18 g m; rounding the corners to 6 * 2^-24 g moves it by 1.5 * 2^-20 g m,
// and the products round by 2^-21 g m: in all less than R m + R^2, R = 1.25 * 2^-17 g. So there is no
// hit where one weight is past R m + R^2 and another below its negative; nor where all corners lie
// beyond the hit so far by more than R.
#include <algorithm>
#include <cmath>

#include "common/simd/four-inl.h"
#include "common/trace/kernels/ray_kernels.h"
#include "common/trace/scaled_ray.h"

#if defined(MDK_RAY_TEST_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MDK_RAY_TEST_INL_H_
#undef MDK_RAY_TEST_INL_H_
#else
#define MDK_RAY_TEST_INL_H_
#endif

HWY_BEFORE_NAMESPACE();
namespace mdk {
namespace HWY_NAMESPACE {
namespace rays {

using DoubleTag = hn::CappedTag<double, kBvhWidth>;
using DoubleVec = hn::Vec<DoubleTag>;
using DoublePoints = Points<DoubleTag>;

// --- the test in double ---

struct Weight {
  DoubleVec value;
  DoubleVec error;  ///< no less than what rounding may have done to the value
};

/// ((b - a) x (b + a)) . d; `rounding` is kRounding times the largest component of d.
HWY_INLINE Weight edge_weight(const DoublePoints& a, const DoublePoints& b, const DoublePoints& d,
                              DoubleVec rounding) {
  const DoublePoints u = b - a, v = b + a;
  return {dot(cross(u, v), d), hn::Mul(hn::Mul(sum_of_sizes(u), sum_of_sizes(v)), rounding)};
}

/// About twenty roundings of 2^-53 each, relative to the sizes of all factors.
constexpr double kRounding = 0x1p-48;

/// One ray against triangles.
class RayTester {
 public:
  RayTester(const WorldRay& ray, RayHit& hit)
      : ray_(ray),
        hit_(hit),
        direction_square_(dot(ray.direction, ray.direction)),
        rounding_(kRounding * std::max({std::abs(ray.direction.x), std::abs(ray.direction.y),
                                        std::abs(ray.direction.z)})) {}

  /// `count` triangles, not more than a vector holds; corner k of triangle i is vertex corner[k][i].
  /// Places up to the lanes of a vector must be vertices, too.
  void test(const std::uint32_t* const (&corner)[3], const std::uint32_t* triangle,
            std::size_t count, const VertexSource& vertices) {
    const auto points = [&](const std::uint32_t* index) {
      const DoubleTag d;
      alignas(64) double x[kBvhWidth], y[kBvhWidth], z[kBvhWidth];
      for (std::size_t i = 0; i < hn::Lanes(d); ++i) {
        const Vec3d v = to_double(vertices.position(index[i])) - ray_.origin;
        x[i] = v.x;
        y[i] = v.y;
        z[i] = v.z;
      }
      return DoublePoints{hn::Load(d, x), hn::Load(d, y), hn::Load(d, z)};
    };
    test_lanes(points(corner[0]), points(corner[1]), points(corner[2]), triangle, count);
  }

  /// One triangle, by the same operations one after another.
  void test_one(const Vec3f& corner_a, const Vec3f& corner_b, const Vec3f& corner_c,
                std::uint32_t triangle) {
    const Vec3d a = to_double(corner_a) - ray_.origin, b = to_double(corner_b) - ray_.origin,
                c = to_double(corner_c) - ray_.origin;
    const Vec3d& d = ray_.direction;
    const auto size = [](const Vec3d& v) { return std::abs(v.x) + std::abs(v.y) + std::abs(v.z); };
    const auto weight = [&](const Vec3d& p, const Vec3d& q, double& error) {
      const Vec3d u = q - p, v = q + p;
      error = size(u) * size(v) * rounding_;
      return dot(cross(u, v), d);
    };
    double ea, eb, ec;
    const double wa = weight(b, c, ea), wb = weight(c, a, eb), wc = weight(a, b, ec);
    const double side = std::copysign(1.0, wa + wb + wc);
    if (!(wa * side >= -ea && wb * side >= -eb && wc * side >= -ec)) return;
    const auto share_of = [&](double w) { return w * side > 0 ? w * side : 0.0; };
    const double sa = share_of(wa), sb = share_of(wb), sc = share_of(wc);
    const double total = sa + sb + sc, share = 1.0 / total;
    const Vec3d p = (a * sa + b * sb + c * sc) * share;
    const double t = dot(p, d) / direction_square_;
    const Vec3d off = p - d * t;
    if (!(dot(off, off) <= dot(p, p) * 0x1p-40 && total > 0)) return;
    keep({static_cast<float>(t), triangle, static_cast<float>(sb * share),
          static_cast<float>(sc * share)});
  }

 private:
  void keep(const RayHit& hit) {
    const bool is_closer = hit.t < hit_.t || (hit.t == hit_.t && hit.triangle < hit_.triangle);
    if (hit.t > ray_.t_min && is_closer) hit_ = hit;
  }

  HWY_INLINE void test_lanes(const DoublePoints& a, const DoublePoints& b, const DoublePoints& c,
                             const std::uint32_t* triangles, std::size_t count) {
    const DoubleTag d;
    const DoublePoints direction = broadcast(d, ray_.direction);
    const auto rounding = hn::Set(d, rounding_);
    const Weight wa = edge_weight(b, c, direction, rounding),
                 wb = edge_weight(c, a, direction, rounding),
                 wc = edge_weight(a, b, direction, rounding);
    const auto zero = hn::Zero(d);
    const auto side = hn::CopySign(hn::Set(d, 1.0), hn::Add(hn::Add(wa.value, wb.value), wc.value));
    const auto is_inner = [&](const Weight& w) {
      return hn::Ge(hn::Mul(w.value, side), hn::Neg(w.error));
    };
    const auto inside = hn::And(hn::And(is_inner(wa), is_inner(wb)), is_inner(wc));
    if (hn::AllFalse(d, inside)) return;

    const auto share_of = [&](const Weight& w) { return hn::Max(hn::Mul(w.value, side), zero); };
    const auto sa = share_of(wa), sb = share_of(wb), sc = share_of(wc);
    const auto total = hn::Add(hn::Add(sa, sb), sc);
    const auto share = hn::Div(hn::Set(d, 1.0), total);
    const DoublePoints p = scaled(scaled(a, sa) + scaled(b, sb) + scaled(c, sc), share);
    const auto t = hn::Div(dot(p, direction), hn::Set(d, direction_square_));
    const DoublePoints off = p - scaled(direction, t);
    const auto close = hn::Le(dot(off, off), hn::Mul(dot(p, p), hn::Set(d, 0x1p-40)));
    // Written so that a corner that is not a number fails it.
    const auto hit = hn::And(inside, hn::And(close, hn::Gt(total, zero)));
    std::uint32_t lanes = mask_bits(d, hit) & ((1u << count) - 1);
    if (lanes == 0) return;

    alignas(64) double depth[kBvhWidth], bary1[kBvhWidth], bary2[kBvhWidth];
    hn::Store(t, d, depth);
    hn::Store(hn::Mul(sb, share), d, bary1);
    hn::Store(hn::Mul(sc, share), d, bary2);
    for (; lanes != 0; lanes &= lanes - 1) {
      const auto i = static_cast<std::size_t>(__builtin_ctz(lanes));
      keep({static_cast<float>(depth[i]), triangles[i], static_cast<float>(bary1[i]),
            static_cast<float>(bary2[i])});
    }
  }

  const WorldRay& ray_;
  RayHit& hit_;
  double direction_square_, rounding_;
};

/// Sixteen numbers, of which lanes pick some.
class Sixteen {
 public:
  static constexpr std::size_t kParts = 16 / hn::MaxLanes(FloatTag());

  HWY_INLINE void set(std::size_t part, FloatVec values) {
    if constexpr (kParts <= 2) {
      part_[part] = values;
    } else {
      hn::Store(values, FloatTag(), stored_ + part * hn::Lanes(FloatTag()));
    }
  }
  using Indices = hn::Vec<hn::RebindToSigned<FloatTag>>;
  HWY_INLINE FloatVec pick(Indices index) const {
    const FloatTag d;
    const hn::RebindToSigned<FloatTag> di;
    if constexpr (kParts == 1) {
      return hn::TableLookupLanes(part_[0], hn::IndicesFromVec(d, index));
    } else if constexpr (kParts == 2) {
      const auto seven = hn::Set(di, 7);
      const auto place = hn::IndicesFromVec(d, hn::And(index, seven));
      return hn::IfThenElse(hn::RebindMask(d, hn::Gt(index, seven)),
                            hn::TableLookupLanes(part_[1], place),
                            hn::TableLookupLanes(part_[0], place));
    } else {
      return hn::GatherIndex(d, stored_, index);
    }
  }

 private:
  FloatVec part_[kParts <= 2 ? kParts : 1];  // in use where a vector can look them up
  alignas(64) float stored_[kParts <= 2 ? 1 : 16];
};

#if HWY_TARGET != HWY_SCALAR
/// In every four lanes a vertex and a lane more: vertex[0], vertex[4], vertex[8]...
template <class D>
HWY_INLINE hn::Vec<D> every_fourth(D d, const std::uint32_t* vertex, const Vec3f* positions) {
  if constexpr (hn::MaxLanes(d) == 4) {
    return hn::LoadU(d, &positions[vertex[0]].x);
  } else {
    const hn::Half<D> half;
    return hn::Combine(d, every_fourth(half, vertex + hn::Lanes(half), positions),
                       every_fourth(half, vertex, positions));
  }
}
#endif

/// As many vertices as a vector holds, at the source's time.
template <class D>
HWY_INLINE Points<D> pose(D d, const std::uint32_t* vertex, const VertexSource& source) {
#if HWY_TARGET == HWY_SCALAR
  const Vec3f p = source.position(vertex[0]);
  return {hn::Set(d, p.x), hn::Set(d, p.y), hn::Set(d, p.z)};
#else
  const auto s = hn::Set(d, source.s);
  const auto row = [&](std::size_t i) {
    const auto from = every_fourth(d, vertex + i, source.from);
    if (source.s == 0.0f) return from;
    const auto to = every_fourth(d, vertex + i, source.to);
    return hn::Add(from, hn::Mul(hn::Sub(to, from), s));
  };
  const auto row0 = row(0), row1 = row(1), row2 = row(2), row3 = row(3);
  const auto xy02 = hn::InterleaveLower(d, row0, row2), xy13 = hn::InterleaveLower(d, row1, row3),
             z02 = hn::InterleaveUpper(d, row0, row2), z13 = hn::InterleaveUpper(d, row1, row3);
  return {hn::InterleaveLower(d, xy02, xy13), hn::InterleaveUpper(d, xy02, xy13),
          hn::InterleaveLower(d, z02, z13)};
#endif
}

/// One ray against blocks.
class RayAndBlocks {
 public:
  /// `center`, `diagonal`: of a box around all that may be met.
  RayAndBlocks(const ScaledRay& ray, const Vec3f& center, float diagonal, RayAim aim, RayHit& hit)
      : ray_(ray.ray),
        query_(ray.query),
        aim_(aim),
        hit_(hit),
        tester_(ray.ray, hit),
        // Four numbers at once: the last ones are of the members behind, and have no meaning.
        origin_(FourFloats::load(&ray.query.origin.x)),
        direction_(to_float(to_double(FourFloats::load(&ray.query.direction.x)) *
                            FourDoubles::all(ray.direction_scale()))),
        reach_(std::abs(center.x - query_.origin.x) + std::abs(center.y - query_.origin.y) +
               std::abs(center.z - query_.origin.z) + diagonal) {}

  bool finished() const { return aim_ == RayAim::kAny && hit_.triangle != kNoHit; }
  RayAim aim() const { return aim_; }
  const RayHit& hit() const { return hit_; }
  const WorldRay& ray() const { return ray_; }
  const FourFloats& origin() const { return origin_; }
  const FourFloats& direction() const { return direction_; }
  /// What boxes in the world must give way by, for the test's sake.
  float slack() const { return reach_ * (1.25f * 0x1p-19f); }

  /// Too far away, or too large, for boxes in float.
  bool is_vast() const { return !(reach_ < 0x1p59f); }

  /// Before the first test(). `inverse`: of the direction, in float.
  HWY_INLINE void prepare(const float (&inverse_of)[4]) {
    const Vec3f& d = query_.direction;
    const std::size_t along = std::abs(d.x) >= std::abs(d.y) && std::abs(d.x) >= std::abs(d.z) ? 0
                              : std::abs(d.y) >= std::abs(d.z)                                 ? 1
                                                                                               : 2;
    const std::size_t x = along == 2 ? 0 : along + 1, y = along == 0 ? 2 : along - 1;
    const float inverse = inverse_of[along];
    for (auto& row : image_) row[0] = row[1] = row[2] = 0;
    image_[0][x] = 1;
    image_[0][along] = static_cast<float>(-ray_.direction[x]) * inverse;
    image_[1][y] = 1;
    image_[1][along] = static_cast<float>(-ray_.direction[y]) * inverse;
    image_[2][along] = inverse;
    // Out of this range, products in float might be lost: nothing is rejected then.
    tolerance_ = reach_ > 0x1p-40f && reach_ < 0x1p60f ? reach_ * (1.25f * 0x1p-17f)
                                                       : std::numeric_limits<float>::infinity();
  }

  /// Vertices: points(d, block, part) gives as many as a vector holds, position(block, place) one.
  template <class Vertices>
  HWY_NOINLINE void test(const RayBlock& block, const Vertices& vertices) {
    const FloatTag d;
    Sixteen x, y, z, size;
    const auto row_of = [&](const float (&row)[3], const Points<FloatTag>& p) {
      return hn::MulAdd(hn::Set(d, row[0]), p.x,
                        hn::MulAdd(hn::Set(d, row[1]), p.y, hn::Mul(hn::Set(d, row[2]), p.z)));
    };
    for (std::size_t part = 0; part < Sixteen::kParts; ++part) {
      const Points<FloatTag> posed = vertices.points(d, block, part * hn::Lanes(d));
      const Points<FloatTag> p{hn::Sub(posed.x, hn::Set(d, query_.origin.x)),
                               hn::Sub(posed.y, hn::Set(d, query_.origin.y)),
                               hn::Sub(posed.z, hn::Set(d, query_.origin.z))};
      const auto across = row_of(image_[0], p), down = row_of(image_[1], p);
      x.set(part, across);
      y.set(part, down);
      z.set(part, row_of(image_[2], p));
      size.set(part, hn::Max(hn::Abs(across), hn::Abs(down)));
    }
    const auto tolerance = hn::Set(d, tolerance_), square = hn::Mul(tolerance, tolerance);
    std::uint32_t passed = 0;
    for (std::size_t first = 0; first < block.count; first += hn::Lanes(d)) {
      const hn::RebindToSigned<FloatTag> di;
      const hn::Rebind<std::uint8_t, FloatTag> db;
      const auto place = [&](std::size_t k) {
        return hn::PromoteTo(di, hn::LoadU(db, block.corner[k] + first));
      };
      const auto a = place(0), b = place(1), c = place(2);
      const auto ax = x.pick(a), ay = y.pick(a), bx = x.pick(b), by = y.pick(b), cx = x.pick(c),
                 cy = y.pick(c);
      const auto wa = hn::MulSub(bx, cy, hn::Mul(by, cx)), wb = hn::MulSub(cx, ay, hn::Mul(cy, ax)),
                 wc = hn::MulSub(ax, by, hn::Mul(ay, bx));
      const auto most = hn::Max(size.pick(a), hn::Max(size.pick(b), size.pick(c)));
      const auto error = hn::MulAdd(most, tolerance, square);
      const auto outside = hn::And(hn::Gt(hn::Max(wa, hn::Max(wb, wc)), error),
                                   hn::Lt(hn::Min(wa, hn::Min(wb, wc)), hn::Neg(error)));
      const auto az = z.pick(a), bz = z.pick(b), cz = z.pick(c);
      const auto beyond = hn::Gt(hn::Min(az, hn::Min(bz, cz)), hn::Set(d, hit_.t + tolerance_));
      const auto rejected = hn::Or(outside, beyond);
      passed |= (mask_bits(d, rejected) ^ ((1u << hn::Lanes(d)) - 1)) << first;
    }
    passed &= (1u << block.count) - 1;
    for (; passed != 0; passed &= passed - 1) {
      const auto lane = static_cast<std::size_t>(__builtin_ctz(passed));
      const auto corner = [&](std::size_t k) {
        return vertices.position(block, block.corner[k][lane]);
      };
      tester_.test_one(corner(0), corner(1), corner(2), block.triangle[lane]);
    }
  }

 private:
  const WorldRay& ray_;
  const QueryRay& query_;
  const RayAim aim_;
  RayHit& hit_;
  RayTester tester_;
  const FourFloats origin_, direction_;
  const float reach_;              ///< no less than any distance to what may be met
  float image_[3][3], tolerance_;  ///< rows of the map into the image, and R
};

}  // namespace rays
}  // namespace HWY_NAMESPACE
}  // namespace mdk
HWY_AFTER_NAMESPACE();

#endif  // per-target guard
