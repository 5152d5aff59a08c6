// SceneTracer: single rays through a scene. The public face is mdk::Scene.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "common/scene/scene.h"
#include "common/trace/instance_trees.h"
#include "common/trace/ray_tracer.h"

namespace mdk {

/// Instances that a ray does not share a bit with are not there for it.
inline constexpr std::uint32_t kAllInstances = 0xffffffff;

/// Safe to use from many threads at once; the stage must outlive it.
class SceneTracer {
 public:
  /// Makes a RayTracer for each model that `tracers` has none for, or takes that. Cost: that, and
  /// InstanceTrees; runs in parallel.
  explicit SceneTracer(const Stage& stage,
                       std::span<const std::shared_ptr<const RayTracer>> tracers = {});

  /// What the ray hits at a scene time, brute force's to the bit; with kAny, some hit if there is
  /// one. A ray that has no direction or is not finite hits nothing.
  SceneHit trace(const QueryRay& ray, double time, RayAim aim,
                 std::uint32_t mask = kAllInstances) const;

  const InstanceTrees& trees() const { return trees_; }
  /// By model.
  std::span<const std::shared_ptr<const RayTracer>> tracers() const { return tracers_; }
  /// What it holds, beside the tracers of models, and those.
  std::size_t own_bytes() const;
  std::size_t model_bytes() const;

 private:
  class Walk;

  const Stage* stage_;
  InstanceTrees trees_;
  std::vector<std::shared_ptr<const RayTracer>> tracers_;
};

/// The closest hit among all triangles of all instances, with no structure at all: what every
/// technique of scenes is judged by. Each instance's is brute_force_closest_hit() of its model for
/// the mapped ray (Stage); the smallest t counts, ties go to the lower instance.
SceneHit brute_force_closest_hit(const Stage& stage, const QueryRay& ray, double time,
                                 std::uint32_t mask = kAllInstances);

}  // namespace mdk
