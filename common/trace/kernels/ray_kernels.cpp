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
#include "common/trace/kernels/ray_kernels.h"

#include <algorithm>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "common/trace/kernels/ray_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// after highway.h
#include "common/trace/kernels/walk-inl.h"

HWY_BEFORE_NAMESPACE();
namespace mdk {
namespace HWY_NAMESPACE {
namespace rays {

using DoubleTag = hn::CappedTag<double, kBvhWidth>;
using DoubleVec = hn::Vec<DoubleTag>;
using DoublePoints = Points<DoubleTag>;

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

/// A ray on its way down one tree (walk-inl.h).
class RayInTree {
 public:
  RayInTree(const BoxRay& ray, RayAim aim, const RayHit& hit) : ray_(ray), aim_(aim), hit_(hit) {}

  HWY_INLINE std::uint32_t enter(const WideBvhNode& node, float (&order)[kBvhWidth]) const {
    const hn::CappedTag<float, kBvhWidth> d;
    std::uint32_t entered = 0;
    for (std::size_t first = 0; first < kBvhWidth; first += hn::Lanes(d)) {
      Slabs slabs(d, ray_.t_begin, hit_.t);
      for (std::size_t axis = 0; axis < 3; ++axis)
        slabs.cut(d, ray_, axis, hn::Load(d, node.bounds[2 * axis] + first),
                  hn::Load(d, node.bounds[2 * axis + 1] + first));
      hn::Store(slabs.near, d, order + first);
      entered |= slabs.entered(d) << first;
    }
    return entered & ((1u << node.count) - 1);
  }
  bool is_past(float order) const { return order > hit_.t; }
  bool finished() const { return aim_ == RayAim::kAny && hit_.triangle != kNoHit; }

 private:
  const BoxRay& ray_;
  RayAim aim_;
  const RayHit& hit_;
};

/// One ray against blocks of triangles.
class RayTester {
 public:
  RayTester(const WorldRay& ray, const VertexSource& vertices, RayHit& hit)
      : ray_(ray),
        vertices_(vertices),
        hit_(hit),
        direction_square_(dot(ray.direction, ray.direction)),
        rounding_(kRounding * std::max({std::abs(ray.direction.x), std::abs(ray.direction.y),
                                        std::abs(ray.direction.z)})) {}

  void test(const TriangleBlock& block) {
    const std::size_t lanes = hn::Lanes(DoubleTag());
    for (std::size_t first = 0; first < block.count; first += lanes) test_lanes(block, first);
  }

 private:
  HWY_INLINE DoublePoints corner(const std::uint32_t* index) const {
    const DoubleTag d;
    alignas(64) double x[kBvhWidth], y[kBvhWidth], z[kBvhWidth];
    for (std::size_t i = 0; i < hn::Lanes(d); ++i) {
      const Vec3d v = to_double(vertices_.position(index[i])) - ray_.origin;
      x[i] = v.x;
      y[i] = v.y;
      z[i] = v.z;
    }
    return {hn::Load(d, x), hn::Load(d, y), hn::Load(d, z)};
  }

  HWY_INLINE void test_lanes(const TriangleBlock& block, std::size_t first) {
    const DoubleTag d;
    const DoublePoints a = corner(block.corner[0] + first), b = corner(block.corner[1] + first),
                       c = corner(block.corner[2] + first);
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
    std::uint32_t lanes = mask_bits(d, hit);
    if (first + hn::Lanes(d) > block.count) lanes &= (1u << (block.count - first)) - 1;
    if (lanes == 0) return;

    alignas(64) double depth[kBvhWidth], bary1[kBvhWidth], bary2[kBvhWidth];
    hn::Store(t, d, depth);
    hn::Store(hn::Mul(sb, share), d, bary1);
    hn::Store(hn::Mul(sc, share), d, bary2);
    for (; lanes != 0; lanes &= lanes - 1) {
      const auto i = static_cast<std::size_t>(__builtin_ctz(lanes));
      const auto at = static_cast<float>(depth[i]);
      const std::uint32_t triangle = block.triangle[first + i];
      const bool is_closer = at < hit_.t || (at == hit_.t && triangle < hit_.triangle);
      if (!(at > ray_.t_min) || !is_closer) continue;
      hit_ = {at, triangle, static_cast<float>(bary1[i]), static_cast<float>(bary2[i])};
    }
  }

  const WorldRay& ray_;
  const VertexSource& vertices_;
  RayHit& hit_;
  double direction_square_, rounding_;
};

std::size_t EnterBoxes(const BoxRay& ray, const MovingBoxes& boxes, float t_max,
                       EnteredBox* entered) {
  const hn::CappedTag<float, kMovingBoxLanes> d;
  const auto s = hn::Set(d, boxes.s);
  const auto row_at = [&](std::size_t row, std::size_t first) {
    const auto from = hn::LoadU(d, boxes.from + row * boxes.stride + first);
    const auto to = hn::LoadU(d, boxes.to + row * boxes.stride + first);
    return hn::Add(from, hn::Mul(hn::Sub(to, from), s));
  };
  alignas(64) float enter[kMovingBoxLanes];
  std::size_t count = 0;
  for (std::size_t first = 0; first < boxes.count; first += hn::Lanes(d)) {
    Slabs slabs(d, ray.t_begin, t_max);
    for (std::size_t axis = 0; axis < 3; ++axis)
      slabs.cut(d, ray, axis, row_at(2 * axis, first), row_at(2 * axis + 1, first));
    std::uint32_t lanes = slabs.entered(d);
    if (boxes.count - first < hn::Lanes(d)) lanes &= (1u << (boxes.count - first)) - 1;
    if (lanes == 0) continue;
    hn::Store(slabs.near, d, enter);
    for (; lanes != 0; lanes &= lanes - 1) {
      const auto lane = static_cast<std::uint32_t>(__builtin_ctz(lanes));
      std::size_t place = count++;
      for (; place > 0 && entered[place - 1].enter > enter[lane]; --place)
        entered[place] = entered[place - 1];
      entered[place] = {static_cast<std::uint32_t>(first) + lane, enter[lane]};
    }
  }
  return count;
}

void Intersect(const WorldRay& ray, const BoxRay& local, const RayTarget& target, RayAim aim,
               RayHit& hit) {
  RayTester tester(ray, target.vertices, hit);
  if (target.nodes.empty()) {
    for (const TriangleBlock& block : target.blocks) tester.test(block);
    return;
  }
  const RayInTree rays(local, aim, hit);
  walk_bvh(target.nodes, rays, [&](std::uint32_t leaf) { tester.test(target.blocks[leaf]); });
}

}  // namespace rays
using rays::EnterBoxes, rays::Intersect;
}  // namespace HWY_NAMESPACE
}  // namespace mdk
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace mdk {

HWY_EXPORT(EnterBoxes);
HWY_EXPORT(Intersect);

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

std::size_t enter_boxes(const BoxRay& ray, const MovingBoxes& boxes, float t_max,
                        EnteredBox* entered) {
  return HWY_DYNAMIC_DISPATCH(EnterBoxes)(ray, boxes, t_max, entered);
}

void intersect(const WorldRay& ray, const BoxRay& local, const RayTarget& target, RayAim aim,
               RayHit& hit) {
  HWY_DYNAMIC_DISPATCH(Intersect)(ray, local, target, aim, hit);
}

}  // namespace mdk
#endif  // HWY_ONCE
