// A ray through a hierarchy over instances: eight boxes at once, near ones first. What is inside of
// a leaf, another basis and another time, is the business of whoever is called (scene_tracer.h).
#pragma once

#include <cstdint>
#include <span>

#include "common/structures/wide_bvh.h"
#include "common/trace/kernels/ray_kernels.h"

namespace mdk {

/// A ray against boxes of one basis. Each plane is moved outward by a slack, which is why there are
/// two origins: one for low sides and one for high sides.
struct BoxRay {
  float origin_for_low[3], origin_for_high[3];
  float inverse[3];  ///< of the direction, finite
  float t_begin;     ///< what ends before it is not entered
};

/// The ray in a basis, for boxes inside `bounds` (of that basis). `world_slack`: what boxes must
/// give way by in the world, for the triangle test's sake.
BoxRay make_box_ray(const WorldRay& ray, const Affine3d& local_from_world, const Aabb& bounds,
                    double world_slack);

/// Whoever looks into the leaves that a ray enters.
class LeafVisitor {
 public:
  /// Returns how far the ray still counts, in the lengths of the BoxRay; below its beginning:
  /// enough.
  virtual float enter(std::uint32_t leaf) = 0;

 protected:
  ~LeafVisitor() = default;
};

/// Calls visitor.enter() for leaves whose boxes the ray enters before `t_max`, or what the last
/// call returned.
void walk_instances(std::span<const WideBvhNode> nodes, const BoxRay& ray, float t_max,
                    LeafVisitor& visitor);

}  // namespace mdk
