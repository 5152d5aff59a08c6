// How a single ray goes through a model at a time of its own, or through one that was posed.
#include "common/trace/kernels/ray_kernels.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "common/trace/kernels/ray_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/cache_control.h>
#include <hwy/highway.h>
// after highway.h
#include "common/trace/kernels/ray_boxes-inl.h"
#include "common/trace/kernels/ray_test-inl.h"
#include "common/trace/kernels/walk-inl.h"
#include "common/trace/query_keys.h"

HWY_BEFORE_NAMESPACE();
namespace mdk {
namespace HWY_NAMESPACE {
namespace rays {

HWY_INLINE FourFloats four_of(const Vec3f& v) {
  const float f[4] = {v.x, v.y, v.z, 0};
  return FourFloats::load(f);
}

/// All blocks of a leaf.
template <class Vertices>
HWY_INLINE void test_leaf(RayAndBlocks& ray, const RayBlock* block, const Vertices& vertices) {
  ray.test(*block, vertices);
  while (block->has_next) ray.test(*++block, vertices);
}

/// Vertices between two keys, which are decoded when the first block asks for one, and held until
/// the ray is done.
class KeyVertices {
 public:
  KeyVertices(const KeyPoses& poses, const KeyInterval& at) : poses_(poses), at_(at) {}
  ~KeyVertices() {
    if (source_.from != nullptr) poses_.release(at_);
  }
  KeyVertices(const KeyVertices&) = delete;
  KeyVertices& operator=(const KeyVertices&) = delete;

  template <class D>
  HWY_INLINE Points<D> points(D d, const RayBlock& block, std::size_t first) const {
    if (HWY_UNLIKELY(source_.from == nullptr)) source_ = poses_.acquire(at_);
    return pose(d, block.vertex + first, source_);
  }
  HWY_INLINE Vec3f position(const RayBlock& block, std::size_t place) const {
    return source_.position(block.vertex[place]);
  }

 private:
  const KeyPoses& poses_;
  const KeyInterval& at_;
  mutable VertexSource source_{nullptr, nullptr, 0};
};

/// One ray on its way through a model.
class RayInModel {
 public:
  RayInModel(const RayModel& model, const ScaledRay& ray, const KeyInterval& at, RayAim aim,
             RayHit& hit)
      : model_(model),
        at_(at),
        ray_(ray, model.center, model.diagonal, aim, hit),
        vertices_(*model.poses, at) {}

  void trace(std::uint32_t segment) {
    trees_ = model_.trees + std::size_t{segment} * model_.clusters;
    const FourFloats s = FourFloats::all(at_.s);
    const KeyBox &from = model_.key_boxes[at_.key0], &to = model_.key_boxes[at_.key1];
    const auto side = [&](const float (&a)[4], const float (&b)[4]) {
      return FourFloats::load(a) + (FourFloats::load(b) - FourFloats::load(a)) * s;
    };
    const FourFloats lo = side(from.lo, to.lo), hi = side(from.hi, to.hi);
    // No box of this time reaches farther.
    const FourFloats size = abs(ray_.origin()) + max(abs(lo), abs(hi));
    BoxRay world(ray_.origin(), ray_.direction(),
                 FourFloats::all(ray_.slack()) + size * FourFloats::all(0x1p-19f),
                 std::min(0.0f, ray_.ray().t_min));
    ray_.prepare(world.inverse);
    if (HWY_UNLIKELY(ray_.is_vast())) world.enter_all();
    if (!world.enters(lo, hi, ray_.hit().t)) return;
    walk_top(world);
  }

 private:
  void walk_top(const BoxRay& world) {
    using Tag = hn::CappedTag<float, kTopWidth>;
    const Tag d;
    const LaneRay<Tag> lanes(d, world);
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
        entered |= lanes.enter(d, ray_.hit().t, order + first,
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
      if (next.order > ray_.hit().t) continue;
      if (!next.child.is_leaf()) {
        open(next.child.index());
        continue;
      }
      enter_cluster(next.child.index());
      if (ray_.finished()) return;
    }
  }

  void enter_cluster(std::uint32_t c) {
    const RayTree& tree = trees_[c];
    const MappedRay mapped = map_into(c);
    const FourFloats size = FourFloats::load(tree.size);
    BoxRay local(mapped.origin, mapped.direction,
                       mapped.stretch * FourFloats::all(ray_.slack()) +
                           (abs(mapped.origin) + size) * FourFloats::all(0x1p-19f),
                       std::min(0.0f, ray_.ray().t_min));
    if (HWY_UNLIKELY(mapped.is_extreme || ray_.is_vast())) local.enter_all();
    RayInTree ray(local, tree.nodes.data(), tree.blocks, ray_.aim(), ray_.hit());
    walk_bvh(tree.nodes, ray, [&](std::uint32_t block) {
      test_leaf(ray_, tree.blocks + block, vertices_);
    });
  }

  /// The ray in a cluster's basis.
  HWY_INLINE MappedRay map_into(std::uint32_t c) const {
    const std::size_t clusters = model_.clusters;
    const std::size_t a = at_.key0 * clusters + c, b = at_.key1 * clusters + c;
    const std::uint8_t needed = at_.key0 == at_.key1 ? kRegularKey : kRegularInterval;
    if (HWY_LIKELY((model_.map_kinds[a] & needed) != 0)) {
      MappedRay ray = map_ray(model_.key_maps[a], model_.key_maps[b], at_.s, ray_.ray().direction,
                              ray_.ray().origin - to_double(model_.center));
      ray.origin = ray.origin + four_of(model_.local_centers[c]);
      return ray;
    }
    return map_irregular(
        interpolate(model_.local_from_world[a], model_.local_from_world[b], at_.s),
        ray_.ray().direction, ray_.ray().origin);
  }

  static constexpr std::size_t kMaxTopDepth = 9;  // 16^8 clusters

  const RayModel& model_;
  const KeyInterval& at_;
  const RayTree* trees_ = nullptr;
  RayAndBlocks ray_;
  KeyVertices vertices_;
};

/// The vertices of posed blocks.
class PosedVertices {
 public:
  explicit PosedVertices(const PosedScene& scene) : scene_(scene) {}

  template <class D>
  HWY_INLINE Points<D> points(D d, const RayBlock& block, std::size_t first) const {
    const PosedRayBlock& posed = of(block);
    return {hn::Load(d, posed.x + first), hn::Load(d, posed.y + first),
            hn::Load(d, posed.z + first)};
  }
  HWY_INLINE Vec3f position(const RayBlock& block, std::size_t place) const {
    const PosedRayBlock& posed = of(block);
    return {posed.x[place], posed.y[place], posed.z[place]};
  }

 private:
  HWY_INLINE const PosedRayBlock& of(const RayBlock& block) const {
    return scene_.posed[&block - scene_.blocks];
  }
  const PosedScene& scene_;
};

QueryHit TraceRay(const RayModel& model, const QueryRay& ray, const KeyInterval& at,
                  std::uint32_t segment, RayAim aim) {
  const ScaledRay scaled(ray);
  if (!scaled.usable) return {};
  RayHit hit = scaled.nothing_yet();
  RayInModel(model, scaled, at, aim, hit).trace(segment);
  return scaled.in_callers_lengths(hit);
}

/// A bit for each of as many rays as a vector holds that may enter the model's bounds, its slack
/// included: what is told for certain, of rays of ordinary lengths.
HWY_INLINE std::uint32_t may_enter(const RayModel& model, const QueryRay* rays, std::size_t count) {
  const FloatTag d;
  alignas(64) float part[8][hn::MaxLanes(FloatTag())] = {};
  static_assert(sizeof(QueryRay) == 8 * sizeof(float));
  for (std::size_t i = 0; i < count; ++i) {
    float numbers[8];
    std::memcpy(numbers, &rays[i], sizeof numbers);
    for (std::size_t k = 0; k < 8; ++k) part[k][i] = numbers[k];
  }
  const Points<FloatTag> o{hn::Load(d, part[0]), hn::Load(d, part[1]), hn::Load(d, part[2])},
      v{hn::Load(d, part[3]), hn::Load(d, part[4]), hn::Load(d, part[5])};
  const Points<FloatTag> away = broadcast(d, model.center) - o;
  const auto reach = hn::Add(sum_of_sizes(away), hn::Set(d, model.diagonal));
  const auto longest = hn::Max(hn::Abs(v.x), hn::Max(hn::Abs(v.y), hn::Abs(v.z)));
  const auto shortest = hn::Mul(longest, hn::Set(d, 0x1p-40f));
  auto near = hn::Min(hn::Zero(d), hn::Load(d, part[6])), far = hn::Load(d, part[7]);
  const auto cut = [&](hn::Vec<FloatTag> origin, hn::Vec<FloatTag> direction, float lo, float hi) {
    const float side = std::max(std::abs(lo), std::abs(hi));
    const auto slack = hn::Mul(hn::Add(reach, hn::Add(hn::Abs(origin), hn::Set(d, side))),
                               hn::Set(d, 0x1p-18f));
    const auto inverse = hn::Div(
        hn::Set(d, 1.0f), hn::CopySign(hn::Max(hn::Abs(direction), shortest), direction));
    const auto a = hn::Mul(hn::Sub(hn::Sub(hn::Set(d, lo), slack), origin), inverse);
    const auto b = hn::Mul(hn::Sub(hn::Add(hn::Set(d, hi), slack), origin), inverse);
    near = hn::Max(near, hn::Min(a, b));
    far = hn::Min(far, hn::Max(a, b));
  };
  cut(o.x, v.x, model.bounds.lo.x, model.bounds.hi.x);
  cut(o.y, v.y, model.bounds.lo.y, model.bounds.hi.y);
  cut(o.z, v.z, model.bounds.lo.z, model.bounds.hi.z);
  const auto ordinary = hn::And(
      hn::Lt(reach, hn::Set(d, kLargestReach)),
      hn::And(hn::Gt(longest, hn::Set(d, 0x1p-40f)), hn::Lt(longest, hn::Set(d, 0x1p40f))));
  const std::uint32_t missed = mask_bits(d, hn::And(ordinary, hn::Gt(near, far)));
  return ~missed & ((1u << count) - 1);
}

void TraceRays(const RayModel& model, const QueryRay* rays, const KeyInterval* times,
               const std::uint32_t* segments, RayAim aim, QueryHit* hits, std::size_t count) {
  const std::size_t lanes = hn::Lanes(FloatTag());
  for (std::size_t first = 0; first < count; first += lanes) {
    const std::size_t some = std::min(lanes, count - first);
    const std::uint32_t entering = may_enter(model, rays + first, some);
    for (std::size_t i = 0; i < some; ++i)
      hits[first + i] = (entering >> i & 1u) != 0 ? TraceRay(model, rays[first + i],
                                                             times[first + i],
                                                             segments[first + i], aim)
                                                  : QueryHit{};
  }
}

QueryHit TracePosed(const PosedScene& scene, const QueryRay& ray, RayAim aim) {
  const ScaledRay scaled(ray);
  if (!scaled.usable) return {};
  RayHit hit = scaled.nothing_yet();
  RayAndBlocks traced(scaled, scene.center, scene.diagonal, aim, hit);
  const FourFloats lo = FourFloats::load(scene.bounds.lo), hi = FourFloats::load(scene.bounds.hi);
  const FourFloats size = abs(traced.origin()) + max(abs(lo), abs(hi));
  BoxRay world(traced.origin(), traced.direction(),
               FourFloats::all(traced.slack()) + size * FourFloats::all(0x1p-19f),
               std::min(0.0f, scaled.ray.t_min));
  traced.prepare(world.inverse);
  if (HWY_UNLIKELY(traced.is_vast())) world.enter_all();
  if (world.enters(lo, hi, hit.t)) {
    const PosedVertices vertices(scene);
    RayInTree in_tree(world, scene.nodes.data(), scene.blocks, aim, hit);
    walk_bvh(scene.nodes, in_tree,
             [&](std::uint32_t block) { test_leaf(traced, scene.blocks + block, vertices); });
  }
  return scaled.in_callers_lengths(hit);
}

void PoseBlocks(std::span<const RayBlock> blocks, const VertexSource& source,
                PosedRayBlock* posed, Aabb* boxes) {
  const FloatTag d;
  const auto infinity = hn::Set(d, std::numeric_limits<float>::infinity());
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    Points<FloatTag> lo{infinity, infinity, infinity},
        hi{hn::Neg(infinity), hn::Neg(infinity), hn::Neg(infinity)};
    for (std::size_t first = 0; first < kBlockVertices; first += hn::Lanes(d)) {
      const Points<FloatTag> p = pose(d, blocks[b].vertex + first, source);
      store(d, p, posed[b].x + first, posed[b].y + first, posed[b].z + first);
      const auto finite = hn::And(hn::Lt(hn::Abs(p.x), infinity),
                                  hn::And(hn::Lt(hn::Abs(p.y), infinity),
                                          hn::Lt(hn::Abs(p.z), infinity)));
      const auto low = [&](auto v) { return hn::IfThenElse(finite, v, infinity); };
      const auto high = [&](auto v) { return hn::IfThenElse(finite, v, hn::Neg(infinity)); };
      lo = {hn::Min(lo.x, low(p.x)), hn::Min(lo.y, low(p.y)), hn::Min(lo.z, low(p.z))};
      hi = {hn::Max(hi.x, high(p.x)), hn::Max(hi.y, high(p.y)), hn::Max(hi.z, high(p.z))};
    }
    const auto least = [&](auto v) { return hn::GetLane(hn::MinOfLanes(d, v)); };
    const auto most = [&](auto v) { return hn::GetLane(hn::MaxOfLanes(d, v)); };
    boxes[b] = {{least(lo.x), least(lo.y), least(lo.z)}, {most(hi.x), most(hi.y), most(hi.z)}};
    if (boxes[b].empty()) boxes[b] = {{0, 0, 0}, {0, 0, 0}};
  }
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
using rays::PoseBlocks, rays::TestBlocks, rays::TracePosed, rays::TraceRay, rays::TraceRays;
}  // namespace HWY_NAMESPACE
}  // namespace mdk
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace mdk {

HWY_EXPORT(PoseBlocks);
HWY_EXPORT(TestBlocks);
HWY_EXPORT(TracePosed);
HWY_EXPORT(TraceRay);
HWY_EXPORT(TraceRays);

QueryHit trace_ray(const RayModel& model, const QueryRay& ray, const KeyInterval& at,
                   std::uint32_t segment, RayAim aim) {
  return HWY_DYNAMIC_DISPATCH(TraceRay)(model, ray, at, segment, aim);
}

void trace_rays(const RayModel& model, const QueryRay* rays, const KeyInterval* times,
                const std::uint32_t* segments, RayAim aim, QueryHit* hits, std::size_t count) {
  HWY_DYNAMIC_DISPATCH(TraceRays)(model, rays, times, segments, aim, hits, count);
}

QueryHit trace_posed(const PosedScene& scene, const QueryRay& ray, RayAim aim) {
  return HWY_DYNAMIC_DISPATCH(TracePosed)(scene, ray, aim);
}

void pose_blocks(std::span<const RayBlock> blocks, const VertexSource& source,
                 PosedRayBlock* posed, Aabb* boxes) {
  HWY_DYNAMIC_DISPATCH(PoseBlocks)(blocks, source, posed, boxes);
}

void test_blocks(const WorldRay& ray, std::span<const TriangleBlock> blocks,
                 const VertexSource& vertices, RayHit& hit) {
  HWY_DYNAMIC_DISPATCH(TestBlocks)(ray, blocks, vertices, hit);
}

}  // namespace mdk
#endif  // HWY_ONCE
