#include "common/trace/kernels/instance_kernel.h"

#include <algorithm>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "common/trace/kernels/instance_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// after highway.h
#include "common/trace/kernels/walk-inl.h"

HWY_BEFORE_NAMESPACE();
namespace mdk {
namespace HWY_NAMESPACE {
namespace instances {

/// A ray on its way down (walk-inl.h).
class RayAmongInstances {
 public:
  RayAmongInstances(const BoxRay& ray, float t_max) : ray_(ray), t_max_(t_max) {}

  HWY_INLINE std::uint32_t enter(const WideBvhNode& node, float (&order)[kBvhWidth]) const {
    const hn::CappedTag<float, kBvhWidth> d;
    std::uint32_t entered = 0;
    for (std::size_t first = 0; first < kBvhWidth; first += hn::Lanes(d)) {
      Slabs slabs(d, ray_.t_begin, t_max_);
      for (std::size_t axis = 0; axis < 3; ++axis)
        slabs.cut(d, ray_, axis, hn::Load(d, node.bounds[2 * axis] + first),
                  hn::Load(d, node.bounds[2 * axis + 1] + first));
      hn::Store(slabs.near, d, order + first);
      entered |= slabs.entered(d) << first;
    }
    return entered & ((1u << node.count) - 1);
  }
  bool is_past(float order) const { return order > t_max_; }
  bool finished() const { return t_max_ < ray_.t_begin; }
  void set_end(float t_max) { t_max_ = t_max; }

 private:
  const BoxRay& ray_;
  float t_max_;
};

void WalkInstances(std::span<const WideBvhNode> nodes, const BoxRay& ray, float t_max,
                   LeafVisitor& visitor) {
  RayAmongInstances rays(ray, t_max);
  walk_bvh(nodes, rays, [&](std::uint32_t leaf) { rays.set_end(visitor.enter(leaf)); });
}

}  // namespace instances
using instances::WalkInstances;
}  // namespace HWY_NAMESPACE
}  // namespace mdk
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace mdk {

HWY_EXPORT(WalkInstances);

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

void walk_instances(std::span<const WideBvhNode> nodes, const BoxRay& ray, float t_max,
                    LeafVisitor& visitor) {
  HWY_DYNAMIC_DISPATCH(WalkInstances)(nodes, ray, t_max, visitor);
}

}  // namespace mdk
#endif  // HWY_ONCE
