// The triangle test of single rays, in double. With corners a, b, c seen from the ray's origin, the
// weight of c at the direction d is ((b - a) x (b + a)) . d, exactly negated when a and b change
// places: two triangles that share an edge agree on which side the ray passes.
//
//     hit where the three weights have one sign, each give or take its rounding: also a ray that
//     meets a vertex exactly, where all signs are rounding, hits one of the triangles around it
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
HWY_BEFORE_NAMESPACE();
namespace mdk {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using FloatTag = hn::CappedTag<float, kBvhWidth>;
using DoubleTag = hn::CappedTag<double, kBvhWidth>;
using DoubleVec = hn::Vec<DoubleTag>;

/// One point per lane. Not `Points`: the tile kernels have another type of that name in this
/// namespace.
struct DoublePoints {
  DoubleVec x, y, z;
};

HWY_INLINE DoublePoints subtract(const DoublePoints& a, const DoublePoints& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE DoublePoints add(const DoublePoints& a, const DoublePoints& b) {
  return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}
HWY_INLINE DoublePoints scale(const DoublePoints& a, DoubleVec s) {
  return {hn::Mul(a.x, s), hn::Mul(a.y, s), hn::Mul(a.z, s)};
}
HWY_INLINE DoubleVec dot_product(const DoublePoints& a, const DoublePoints& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
HWY_INLINE DoubleVec sum_of_sizes(const DoublePoints& a) {
  return hn::Add(hn::Add(hn::Abs(a.x), hn::Abs(a.y)), hn::Abs(a.z));
}

struct Weight {
  DoubleVec value;
  DoubleVec error;  ///< no less than what rounding may have done to the value
};

/// Where a ray is inside the slabs of as many boxes as a vector has lanes.
template <class Tag>
struct Slabs {
  hn::Vec<Tag> near, far;

  Slabs(Tag d, float t_max) : near(hn::Zero(d)), far(hn::Set(d, t_max)) {}
  HWY_INLINE void cut(Tag d, const BoxRay& ray, std::size_t axis, hn::Vec<Tag> low_side,
                      hn::Vec<Tag> high_side) {
    const auto inverse = hn::Set(d, ray.inverse[axis]);
    const auto low = hn::Mul(hn::Sub(low_side, hn::Set(d, ray.origin_for_low[axis])), inverse);
    const auto high = hn::Mul(hn::Sub(high_side, hn::Set(d, ray.origin_for_high[axis])), inverse);
    near = hn::Max(near, hn::Min(low, high));
    far = hn::Min(far, hn::Max(low, high));
  }
  HWY_INLINE std::uint32_t met(Tag d) const {
    alignas(8) std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, hn::Le(near, far), bits);
    return bits[0] | std::uint32_t{bits[1]} << 8;
  }
};

/// ((b - a) x (b + a)) . d; `rounding` is kRounding times the largest component of d.
HWY_INLINE Weight edge_weight(const DoublePoints& a, const DoublePoints& b, const DoublePoints& d,
                              DoubleVec rounding) {
  const DoublePoints u = subtract(b, a), v = add(b, a);
  const DoublePoints n{hn::Sub(hn::Mul(u.y, v.z), hn::Mul(u.z, v.y)),
                       hn::Sub(hn::Mul(u.z, v.x), hn::Mul(u.x, v.z)),
                       hn::Sub(hn::Mul(u.x, v.y), hn::Mul(u.y, v.x))};
  return {dot_product(n, d), hn::Mul(hn::Mul(sum_of_sizes(u), sum_of_sizes(v)), rounding)};
}

/// About twenty roundings of 2^-53 each, relative to the sizes of all factors.
constexpr double kRounding = 0x1p-48;

class RayWalk {
 public:
  RayWalk(const WorldRay& ray, const VertexSource& vertices, RayHit& hit)
      : ray_(ray),
        vertices_(vertices),
        hit_(hit),
        direction_square_(dot(ray.direction, ray.direction)),
        rounding_(kRounding * std::max({std::abs(ray.direction.x), std::abs(ray.direction.y),
                                        std::abs(ray.direction.z)})) {}

  void walk(std::span<const WideBvhNode> nodes, const TriangleBlock* blocks, const BoxRay& local,
            RayAim aim) {
    if (nodes.empty()) return;
    std::size_t size = 0;
    stack_[size++] = {WideBvhChild::inner(0), 0};
    while (size > 0) {
      const Entry entry = stack_[--size];
      if (entry.enter > hit_.t) continue;
      if (!entry.child.is_leaf()) {
        size = push_children(nodes[entry.child.index()], local, size);
        continue;
      }
      test_block(blocks[entry.child.index()]);
      if (aim == RayAim::kAny && hit_.triangle != kNoItem) return;
    }
  }

  void test_block(const TriangleBlock& block) {
    const std::size_t lanes = hn::Lanes(DoubleTag());
    for (std::size_t first = 0; first < block.count; first += lanes) test_lanes(block, first);
  }

 private:
  struct Entry {
    WideBvhChild child;
    float enter;
  };
  static constexpr std::size_t kStackSize = (kBvhWidth - 1) * (kMaxBvhDepth + 1) + 1;

  /// Puts the children that the ray meets on the stack, the nearest on top.
  HWY_INLINE std::size_t push_children(const WideBvhNode& node, const BoxRay& local,
                                       std::size_t size) {
    const FloatTag d;
    alignas(64) float enter[kBvhWidth];
    std::uint32_t met = 0;
    for (std::size_t first = 0; first < kBvhWidth; first += hn::Lanes(d)) {
      Slabs<FloatTag> slabs(d, hit_.t);
      for (std::size_t axis = 0; axis < 3; ++axis)
        slabs.cut(d, local, axis, hn::Load(d, node.bounds[2 * axis] + first),
                  hn::Load(d, node.bounds[2 * axis + 1] + first));
      hn::Store(slabs.near, d, enter + first);
      met |= slabs.met(d) << first;
    }
    const std::size_t bottom = size;
    for (met &= (1u << node.count) - 1; met != 0; met &= met - 1) {
      const auto c = static_cast<std::size_t>(__builtin_ctz(met));
      std::size_t place = size++;
      for (; place > bottom && stack_[place - 1].enter < enter[c]; --place)
        stack_[place] = stack_[place - 1];
      stack_[place] = {node.child[c], enter[c]};
    }
    return size;
  }

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
    const DoublePoints direction{hn::Set(d, ray_.direction.x), hn::Set(d, ray_.direction.y),
                                 hn::Set(d, ray_.direction.z)};
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
    const DoublePoints p = scale(add(add(scale(a, sa), scale(b, sb)), scale(c, sc)), share);
    const auto t = hn::Div(dot_product(p, direction), hn::Set(d, direction_square_));
    const DoublePoints off = subtract(p, scale(direction, t));
    const auto close =
        hn::Le(dot_product(off, off), hn::Mul(dot_product(p, p), hn::Set(d, 0x1p-40)));
    // Written so that a corner that is not a number fails it.
    const auto hit = hn::And(inside, hn::And(close, hn::Gt(total, zero)));
    alignas(8) std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, hit, bits);
    std::uint32_t met = bits[0];
    if (first + hn::Lanes(d) > block.count) met &= (1u << (block.count - first)) - 1;
    if (met == 0) return;

    alignas(64) double depth[kBvhWidth], bary1[kBvhWidth], bary2[kBvhWidth];
    hn::Store(t, d, depth);
    hn::Store(hn::Mul(sb, share), d, bary1);
    hn::Store(hn::Mul(sc, share), d, bary2);
    for (; met != 0; met &= met - 1) {
      const auto i = static_cast<std::size_t>(__builtin_ctz(met));
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
  Entry stack_[kStackSize];
};

std::size_t Meet(const BoxRay& ray, const MovingBoxes& boxes, float t_max, MetBox* met) {
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
    Slabs<decltype(d)> slabs(d, t_max);
    for (std::size_t axis = 0; axis < 3; ++axis)
      slabs.cut(d, ray, axis, row_at(2 * axis, first), row_at(2 * axis + 1, first));
    std::uint32_t lanes = slabs.met(d);
    if (boxes.count - first < hn::Lanes(d)) lanes &= (1u << (boxes.count - first)) - 1;
    if (lanes == 0) continue;
    hn::Store(slabs.near, d, enter);
    for (; lanes != 0; lanes &= lanes - 1) {
      const auto lane = static_cast<std::uint32_t>(__builtin_ctz(lanes));
      std::size_t place = count++;
      for (; place > 0 && met[place - 1].enter > enter[lane]; --place) met[place] = met[place - 1];
      met[place] = {static_cast<std::uint32_t>(first) + lane, enter[lane]};
    }
  }
  return count;
}

void Cluster(const WorldRay& ray, const BoxRay& local, const ClusterQuery& cluster, RayAim aim,
             RayHit& hit) {
  RayWalk(ray, cluster.vertices, hit).walk(cluster.nodes, cluster.blocks, local, aim);
}

void Blocks(const WorldRay& ray, std::span<const TriangleBlock> blocks,
            const VertexSource& vertices, RayHit& hit) {
  RayWalk walk(ray, vertices, hit);
  for (const TriangleBlock& block : blocks) walk.test_block(block);
}

}  // namespace HWY_NAMESPACE
}  // namespace mdk
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace mdk {

HWY_EXPORT(Meet);
HWY_EXPORT(Cluster);
HWY_EXPORT(Blocks);

BoxRay make_box_ray(const Vec3d& origin, const Vec3d& direction, const Affine3d& local_from_world,
                    const Aabb& bounds, double world_slack) {
  const Vec3d local_origin = local_from_world.point(origin);
  const Vec3d local_direction = local_from_world.vector(direction);
  const double longest = std::max(
      {std::abs(local_direction.x), std::abs(local_direction.y), std::abs(local_direction.z)});
  // A component so small moves the ray by less than the slack on its way to anything; kept from
  // zero, its inverse is finite and no product is without a value.
  const double least = std::max(longest * 0x1p-40, 1e-30);
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
        1 / (std::abs(component) < least ? std::copysign(least, component) : component));
  }
  return ray;
}

std::size_t meet_boxes(const BoxRay& ray, const MovingBoxes& boxes, float t_max, MetBox* met) {
  return HWY_DYNAMIC_DISPATCH(Meet)(ray, boxes, t_max, met);
}

void intersect_cluster(const WorldRay& ray, const BoxRay& local, const ClusterQuery& cluster,
                       RayAim aim, RayHit& hit) {
  HWY_DYNAMIC_DISPATCH(Cluster)(ray, local, cluster, aim, hit);
}

void intersect_blocks(const WorldRay& ray, std::span<const TriangleBlock> blocks,
                      const VertexSource& vertices, RayHit& hit) {
  HWY_DYNAMIC_DISPATCH(Blocks)(ray, blocks, vertices, hit);
}

}  // namespace mdk
#endif  // HWY_ONCE
