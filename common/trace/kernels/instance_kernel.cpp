#include "common/trace/kernels/instance_kernel.h"

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

void walk_instances(std::span<const WideBvhNode> nodes, const BoxRay& ray, float t_max,
                    LeafVisitor& visitor) {
  HWY_DYNAMIC_DISPATCH(WalkInstances)(nodes, ray, t_max, visitor);
}

}  // namespace mdk
#endif  // HWY_ONCE
