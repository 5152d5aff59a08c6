// The triangle test of single rays, in double. With corners a, b, c seen from the ray's origin, the
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
// beyond the hit so far, or before t_min, by more than R.
#include "common/trace/kernels/ray_kernels.h"

#include <algorithm>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "common/trace/kernels/ray_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// after highway.h
#include "common/trace/kernels/walk-inl.h"
#include "common/trace/query_keys.h"

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

// --- boxes ---

/// A ray against boxes of one basis, as make_box_ray() has it, its numbers in every lane: per axis
/// the plane that it meets first, and last.
template <class D>
class LaneRay {
 public:
  HWY_INLINE LaneRay(D d, const BoxRay& ray) : t_begin_(hn::Set(d, ray.t_begin)) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const bool rises = ray.inverse[axis] >= 0;
      near_row_[axis] = static_cast<std::uint32_t>(2 * axis + (rises ? 0 : 1));
      near_[axis] = hn::Set(d, rises ? ray.origin_for_low[axis] : ray.origin_for_high[axis]);
      far_[axis] = hn::Set(d, rises ? ray.origin_for_high[axis] : ray.origin_for_low[axis]);
      inverse_[axis] = hn::Set(d, ray.inverse[axis]);
    }
  }

  /// Bits of the boxes entered before t_max; where, into `order`. row(i) is a vector of planes.
  template <class Row>
  HWY_INLINE std::uint32_t enter(D d, float t_max, float* order, const Row& row) const {
    auto near = t_begin_, far = hn::Set(d, t_max);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      near = hn::Max(near, hn::Mul(hn::Sub(row(near_row_[axis]), near_[axis]), inverse_[axis]));
      far = hn::Min(far,
                    hn::Mul(hn::Sub(row(near_row_[axis] ^ 1u), far_[axis]), inverse_[axis]));
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
  HWY_INLINE RayInTree(const BoxRay& ray, RayAim aim, const RayHit& hit)
      : ray_(Tag(), ray), aim_(aim), hit_(hit) {}

  HWY_INLINE std::uint32_t enter(const WideBvhNode& node, float (&order)[kBvhWidth]) const {
    const Tag d;
    std::uint32_t entered = 0;
    for (std::size_t first = 0; first < kBvhWidth; first += hn::Lanes(d))
      entered |= ray_.enter(d, hit_.t, order + first,
                            [&](std::uint32_t row) {
                              return hn::Load(d, node.bounds[row] + first);
                            })
                 << first;
    return entered & ((1u << node.count) - 1);
  }
  bool is_past(float order) const { return order > hit_.t; }
  bool finished() const { return aim_ == RayAim::kAny && hit_.triangle != kNoHit; }

 private:
  using Tag = hn::CappedTag<float, kBvhWidth>;
  LaneRay<Tag> ray_;
  RayAim aim_;
  const RayHit& hit_;
};

// --- blocks ---

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
/// Four vertices at the source's time; a lane more than a vertex has is read.
HWY_INLINE Points<hn::FixedTag<float, 4>> pose_four(const std::uint32_t* vertex,
                                                    const VertexSource& source) {
  const hn::FixedTag<float, 4> d;
  const auto s = hn::Set(d, source.s);
  hn::Vec<hn::FixedTag<float, 4>> row[4];
  for (std::size_t i = 0; i < 4; ++i) {
    const auto from = hn::LoadU(d, &source.from[vertex[i]].x);
    const auto to = hn::LoadU(d, &source.to[vertex[i]].x);
    row[i] = hn::Add(from, hn::Mul(hn::Sub(to, from), s));
  }
  const auto xy02 = hn::InterleaveLower(d, row[0], row[2]),
             xy13 = hn::InterleaveLower(d, row[1], row[3]),
             z02 = hn::InterleaveUpper(d, row[0], row[2]),
             z13 = hn::InterleaveUpper(d, row[1], row[3]);
  return {hn::InterleaveLower(d, xy02, xy13), hn::InterleaveUpper(d, xy02, xy13),
          hn::InterleaveLower(d, z02, z13)};
}
#endif

/// As many vertices as a vector holds.
template <class D>
HWY_INLINE Points<D> pose(D d, const std::uint32_t* vertex, const VertexSource& source) {
#if HWY_TARGET == HWY_SCALAR
  const Vec3f p = source.position(vertex[0]);
  return {hn::Set(d, p.x), hn::Set(d, p.y), hn::Set(d, p.z)};
#else
  if constexpr (hn::MaxLanes(d) == 4) {
    return pose_four(vertex, source);
  } else {
    const hn::Half<D> half;
    const auto low = pose(half, vertex, source),
               high = pose(half, vertex + hn::Lanes(half), source);
    return {hn::Combine(d, high.x, low.x), hn::Combine(d, high.y, low.y),
            hn::Combine(d, high.z, low.z)};
  }
#endif
}

/// A ray by the inverse of `from` + s (`to` - `from`). `stretch`: no less than what the inverse
/// makes of a box of half side 1, along each axis, but for rounding.
struct MappedRay {
  alignas(16) float origin[4], direction[4], stretch[4];
};

/// With rows X, Y, Z of the map's linear part, its inverse has the columns Y x Z, Z x X and X x Y,
/// over X . (Y x Z). A column's components stand in the order z, x, y.
HWY_INLINE MappedRay map_ray(const KeyMap& from, const KeyMap& to, double s,
                             const Vec3d& direction, const Vec3d& origin) {
  MappedRay ray;
#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL
  const hn::FixedTag<double, 4> d;
  const hn::FixedTag<float, 4> df;
  const hn::FixedTag<std::int64_t, 4> di;
  alignas(32) static constexpr std::int64_t kTurn[4] = {1, 2, 0, 3};
  const auto turn_indices = hn::IndicesFromVec(d, hn::Load(di, kTurn));
  const auto last_index = hn::IndicesFromVec(d, hn::Set(di, 3));
  const auto turned = [&](auto v) { return hn::TableLookupLanes(v, turn_indices); };
  const auto row = [&](int j) {
    const auto a = hn::PromoteTo(d, hn::LoadU(df, from.m[j])),
               b = hn::PromoteTo(d, hn::LoadU(df, to.m[j]));
    return hn::Add(a, hn::Mul(hn::Sub(b, a), hn::Set(d, s)));
  };
  const auto x = row(0), y = row(1), z = row(2);
  const auto tx = turned(x), ty = turned(y), tz = turned(z);
  const auto cx = hn::Sub(hn::Mul(y, tz), hn::Mul(ty, z)),
             cy = hn::Sub(hn::Mul(z, tx), hn::Mul(tz, x)),
             cz = hn::Sub(hn::Mul(x, ty), hn::Mul(tx, y));
  // The last lane of a column is 0: there stand the same two numbers.
  const auto scale = hn::Div(hn::Set(d, 1.0), hn::SumOfLanes(d, hn::Mul(cx, turned(tx))));
  const auto part = [&](auto column, double component, auto r) {
    return hn::Mul(column, hn::Sub(hn::Set(d, component), hn::TableLookupLanes(r, last_index)));
  };
  const auto o = hn::Mul(
      hn::Add(hn::Add(part(cx, origin.x, x), part(cy, origin.y, y)), part(cz, origin.z, z)), scale);
  const auto v = hn::Mul(hn::Add(hn::Add(hn::Mul(cx, hn::Set(d, direction.x)),
                                         hn::Mul(cy, hn::Set(d, direction.y))),
                                 hn::Mul(cz, hn::Set(d, direction.z))),
                         scale);
  const auto stretch =
      hn::Mul(hn::Add(hn::Add(hn::Abs(cx), hn::Abs(cy)), hn::Abs(cz)), hn::Abs(scale));
  hn::Store(hn::DemoteTo(df, turned(o)), df, ray.origin);
  hn::Store(hn::DemoteTo(df, turned(v)), df, ray.direction);
  hn::Store(hn::DemoteTo(df, turned(stretch)), df, ray.stretch);
#else
  double m[3][4], column[3][3];
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 4; ++i)
      m[j][i] = from.m[j][i] + (static_cast<double>(to.m[j][i]) - from.m[j][i]) * s;
  for (int j = 0; j < 3; ++j) {
    const double *u = m[(j + 1) % 3], *v = m[(j + 2) % 3];
    for (int k = 0; k < 3; ++k)
      column[j][k] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
  }
  const double scale =
      1 / (m[0][0] * column[0][0] + m[0][1] * column[0][1] + m[0][2] * column[0][2]);
  const double o[3] = {origin.x - m[0][3], origin.y - m[1][3], origin.z - m[2][3]};
  for (int k = 0; k < 3; ++k) {
    const double cx = column[0][k], cy = column[1][k], cz = column[2][k];
    ray.origin[k] = static_cast<float>((cx * o[0] + cy * o[1] + cz * o[2]) * scale);
    ray.direction[k] =
        static_cast<float>((cx * direction.x + cy * direction.y + cz * direction.z) * scale);
    ray.stretch[k] =
        static_cast<float>((std::abs(cx) + std::abs(cy) + std::abs(cz)) * std::abs(scale));
  }
#endif
  return ray;
}

/// One ray on its way through a model.
class RayInModel {
 public:
  RayInModel(const RayModel& model, const WorldRay& ray, const KeyInterval& at, RayAim aim,
             RayHit& hit)
      : model_(model), ray_(ray), at_(at), aim_(aim), hit_(hit), tester_(ray, hit) {
    for (std::size_t k = 0; k < 3; ++k) {
      origin_[k] = static_cast<float>(ray.origin[k]);
      direction_[k] = static_cast<float>(ray.direction[k]);
    }
    reach_ = std::abs(model.center.x - origin_[0]) + std::abs(model.center.y - origin_[1]) +
             std::abs(model.center.z - origin_[2]) + model.diagonal;
    slack_ = reach_ * (1.25f * 0x1p-19f);
  }

  void trace(std::uint32_t segment) {
    trees_ = model_.trees + std::size_t{segment} * model_.clusters;
    if (!enter_model()) return;
    set_filter();
    walk_top();
  }

 private:
  bool finished() const { return aim_ == RayAim::kAny && hit_.triangle != kNoHit; }

  /// Prepares the ray for the world's boxes; whether it enters the model's at its time.
  bool enter_model() {
    const Aabb &from = model_.key_boxes[at_.key0], &to = model_.key_boxes[at_.key1];
    float near = std::min(0.0f, ray_.t_min), far = hit_.t;
    world_.t_begin = near;
    for (std::size_t k = 0; k < 3; ++k) {
      const float d = direction_[k];
      const float inverse = 1 / (std::abs(d) < kShortest ? std::copysign(kShortest, d) : d);
      const float lo = from.lo[k] + (to.lo[k] - from.lo[k]) * at_.s;
      const float hi = from.hi[k] + (to.hi[k] - from.hi[k]) * at_.s;
      // No box of this time reaches farther.
      const float size = std::abs(origin_[k]) + std::max(std::abs(lo), std::abs(hi));
      const float slack = slack_ + size * 0x1p-19f;
      world_.inverse[k] = inverse;
      world_.origin_for_low[k] = origin_[k] + slack;
      world_.origin_for_high[k] = origin_[k] - slack;
      const float a = (lo - world_.origin_for_low[k]) * inverse,
                  b = (hi - world_.origin_for_high[k]) * inverse;
      near = std::max(near, std::min(a, b));
      far = std::min(far, std::max(a, b));
    }
    return near <= far;
  }

  void set_filter() {
    std::size_t along = 0;
    for (std::size_t k = 1; k < 3; ++k)
      if (std::abs(direction_[k]) > std::abs(direction_[along])) along = k;
    const std::size_t x = (along + 1) % 3, y = (along + 2) % 3;
    const float inverse = 1 / direction_[along];
    for (auto& row : image_) row[0] = row[1] = row[2] = 0;
    image_[0][x] = 1;
    image_[0][along] = -direction_[x] * inverse;
    image_[1][y] = 1;
    image_[1][along] = -direction_[y] * inverse;
    image_[2][along] = inverse;
    // Out of this range, products in float might be lost: nothing is rejected then.
    tolerance_ = reach_ > 0x1p-40f && reach_ < 0x1p60f ? reach_ * (1.25f * 0x1p-17f)
                                                       : std::numeric_limits<float>::infinity();
  }

  void walk_top() {
    using Tag = hn::CappedTag<float, kTopWidth>;
    const Tag d;
    const LaneRay<Tag> ray(d, world_);
    const std::size_t nodes = model_.top_nodes;
    const TopBoxes* from = model_.top_boxes + nodes * at_.key0;
    const TopBoxes* to = model_.top_boxes + nodes * at_.key1;
    const auto s = hn::Set(d, at_.s);
    WaitingChild stack[kTopWidth * kMaxTopDepth];
    std::size_t size = 0;
    const auto open = [&](std::uint32_t node) {
      alignas(64) float order[kTopWidth];
      std::uint32_t entered = 0;
      for (std::size_t first = 0; first < kTopWidth; first += hn::Lanes(d))
        entered |= ray.enter(d, hit_.t, order + first,
                             [&](std::uint32_t row) {
                               const auto a = hn::Load(d, from[node].bounds[row] + first);
                               const auto b = hn::Load(d, to[node].bounds[row] + first);
                               return hn::Add(a, hn::Mul(hn::Sub(b, a), s));
                             })
                   << first;
      const TopLinks& links = model_.top_links[node];
      entered &= (1u << links.count) - 1;
      const std::size_t bottom = size;
      for (; entered != 0; entered &= entered - 1) {
        const auto c = static_cast<std::size_t>(__builtin_ctz(entered));
        const WaitingChild child{order[c], links.child[c]};
        std::size_t place = size++;
        for (; place > bottom && stack[place - 1].order < child.order; --place)
          stack[place] = stack[place - 1];
        stack[place] = child;
      }
    };
    for (std::uint32_t i = 1; i <= model_.top_roots; ++i) open(model_.top_nodes - i);
    while (size > 0) {
      const WaitingChild next = stack[--size];
      if (next.order > hit_.t) continue;
      if (!next.child.is_leaf()) {
        open(next.child.index());
        continue;
      }
      enter_cluster(next.child.index());
      if (finished()) return;
    }
  }

  void enter_cluster(std::uint32_t c) {
    const RayTree& tree = trees_[c];
    BoxRay local;
    set_local(c, tree.bounds, local);
    RayInTree ray(local, aim_, hit_);
    walk_bvh(tree.nodes, ray, [&](std::uint32_t block) {
      const RayBlock* b = tree.blocks + block;
      test_block(*b);
      while (b->has_next) test_block(*++b);
    });
  }

  /// The ray in the cluster's basis.
  void set_local(std::uint32_t c, const Aabb& bounds, BoxRay& local) const {
    const std::size_t clusters = model_.clusters;
    const std::size_t a = at_.key0 * clusters + c, b = at_.key1 * clusters + c;
    const std::uint8_t needed = at_.key0 == at_.key1 ? kRegularKey : kRegularInterval;
    if ((model_.map_kinds[a] & needed) == 0) {
      local = make_box_ray(
          ray_, interpolate(model_.local_from_world[a], model_.local_from_world[b], at_.s), bounds,
          static_cast<double>(slack_));
      return;
    }
    const MappedRay mapped = map_ray(model_.key_maps[a], model_.key_maps[b], at_.s, ray_.direction,
                                     ray_.origin - to_double(model_.center));
    for (std::size_t k = 0; k < 3; ++k) {
      const float o = mapped.origin[k] + model_.local_centers[c][k], d = mapped.direction[k];
      const float size = std::abs(o) + std::max(std::abs(bounds.lo[k]), std::abs(bounds.hi[k]));
      const float slack = mapped.stretch[k] * slack_ + size * 0x1p-19f;
      local.origin_for_low[k] = o + slack;
      local.origin_for_high[k] = o - slack;
      local.inverse[k] = 1 / (std::abs(d) < kShortest ? std::copysign(kShortest, d) : d);
    }
    local.t_begin = world_.t_begin;
  }

  HWY_NOINLINE void test_block(const RayBlock& block) {
    if (vertices_.from == nullptr)
      vertices_ = {model_.poses->key(at_.key0), model_.poses->key(at_.key1), at_.s};
    const FloatTag d;
    Sixteen x, y, z, size;
    const auto row_of = [&](const float (&row)[3], const Points<FloatTag>& p) {
      return hn::MulAdd(hn::Set(d, row[0]), p.x,
                        hn::MulAdd(hn::Set(d, row[1]), p.y, hn::Mul(hn::Set(d, row[2]), p.z)));
    };
    for (std::size_t part = 0; part < Sixteen::kParts; ++part) {
      const Points<FloatTag> posed = pose(d, block.vertex + part * hn::Lanes(d), vertices_);
      const Points<FloatTag> p{hn::Sub(posed.x, hn::Set(d, origin_[0])),
                               hn::Sub(posed.y, hn::Set(d, origin_[1])),
                               hn::Sub(posed.z, hn::Set(d, origin_[2]))};
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
      const auto before =
          hn::Lt(hn::Max(az, hn::Max(bz, cz)), hn::Set(d, ray_.t_min - tolerance_));
      const auto rejected = hn::Or(outside, hn::Or(beyond, before));
      passed |= (mask_bits(d, rejected) ^ ((1u << hn::Lanes(d)) - 1)) << first;
    }
    passed &= (1u << block.count) - 1;
    for (; passed != 0; passed &= passed - 1) {
      const auto lane = static_cast<std::size_t>(__builtin_ctz(passed));
      const auto corner = [&](std::size_t k) {
        return vertices_.position(block.vertex[block.corner[k][lane]]);
      };
      tester_.test_one(corner(0), corner(1), corner(2), block.triangle[lane]);
    }
  }

  static constexpr float kShortest = 1e-30f;
  static constexpr std::size_t kMaxTopDepth = 9;  // 16^8 clusters

  const RayModel& model_;
  const WorldRay& ray_;
  const KeyInterval& at_;
  const RayAim aim_;
  RayHit& hit_;
  RayTester tester_;
  const RayTree* trees_ = nullptr;
  VertexSource vertices_{nullptr, nullptr, 0};
  float origin_[3], direction_[3];
  float reach_, slack_;
  BoxRay world_;
  float image_[3][3], tolerance_;  ///< rows of the map into the image, and R
};

void TraceRay(const RayModel& model, const WorldRay& ray, const KeyInterval& at,
              std::uint32_t segment, RayAim aim, RayHit& hit) {
  RayInModel(model, ray, at, aim, hit).trace(segment);
}

void TestBlocks(const WorldRay& ray, std::span<const TriangleBlock> blocks,
                const VertexSource& vertices, RayHit& hit) {
  RayTester tester(ray, hit);
  const std::size_t lanes = hn::Lanes(DoubleTag());
  for (const TriangleBlock& block : blocks)
    for (std::size_t first = 0; first < block.count; first += lanes)
      tester.test({block.corner[0] + first, block.corner[1] + first, block.corner[2] + first},
                  block.triangle + first, std::min(lanes, block.count - first), vertices);
}

}  // namespace rays
using rays::TestBlocks, rays::TraceRay;
}  // namespace HWY_NAMESPACE
}  // namespace mdk
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace mdk {

HWY_EXPORT(TraceRay);
HWY_EXPORT(TestBlocks);

BoxRay make_box_ray(const WorldRay& world, const Affine3d& local_from_world, const Aabb& bounds,
                    double world_slack) {
  const Vec3d local_origin = local_from_world.point(world.origin);
  const Vec3d local_direction = local_from_world.vector(world.direction);
  const double longest = std::max(
      {std::abs(local_direction.x), std::abs(local_direction.y), std::abs(local_direction.z)});
  // A component so small moves the ray by less than the slack on its way to anything; kept from
  // zero, its inverse is finite and no product is without a value.
  const double shortest = std::max(longest * 0x1p-40, 1e-30);
  BoxRay ray;
  for (std::size_t k = 0; k < 3; ++k) {
    const double* row = local_from_world.m[k];
    const double stretch = std::abs(row[0]) + std::abs(row[1]) + std::abs(row[2]);
    const double size =
        std::abs(local_origin[k]) + std::max(std::abs(static_cast<double>(bounds.lo[k])),
                                             std::abs(static_cast<double>(bounds.hi[k])));
    const double slack = stretch * world_slack + size * 0x1p-19;
    ray.origin_for_low[k] = static_cast<float>(local_origin[k] + slack);
    ray.origin_for_high[k] = static_cast<float>(local_origin[k] - slack);
    const double component = local_direction[k];
    ray.inverse[k] = static_cast<float>(
        1 / (std::abs(component) < shortest ? std::copysign(shortest, component) : component));
  }
  ray.t_begin = std::min(0.0f, world.t_min);
  return ray;
}

void trace_ray(const RayModel& model, const WorldRay& ray, const KeyInterval& at,
               std::uint32_t segment, RayAim aim, RayHit& hit) {
  HWY_DYNAMIC_DISPATCH(TraceRay)(model, ray, at, segment, aim, hit);
}

void test_blocks(const WorldRay& ray, std::span<const TriangleBlock> blocks,
                 const VertexSource& vertices, RayHit& hit) {
  HWY_DYNAMIC_DISPATCH(TestBlocks)(ray, blocks, vertices, hit);
}

}  // namespace mdk
#endif  // HWY_ONCE
