// A ray through a hierarchy over instances: eight boxes at once, near ones first. What is inside of
// a leaf, another basis and another time, is the business of whoever is called (scene_tracer.h).
#pragma once

#include <cstdint>
#include <span>

#include "common/structures/wide_bvh.h"
#include "common/trace/kernels/ray_kernels.h"

namespace mdk {

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
