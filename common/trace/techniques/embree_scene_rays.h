// PeerSceneRays: a scene's single rays through Embree, to measure ours against: one motion-blur
// hierarchy a model, shared by all its instances, which are primitives of a user geometry that maps
// the ray and remaps its time. No other use of Embree holds characters at times of their own
// without a copy for each.
#pragma once

#include <cstddef>
#include <memory>

#include "common/scene/scene.h"
#include "common/trace/techniques/embree_rays.h"

namespace mdk {

class PeerSceneRays {
 public:
  virtual ~PeerSceneRays() = default;
  /// As SceneTracer's. Safe to call from many threads at once.
  virtual SceneHit trace(const QueryRay& ray, double time, RayAim aim) const = 0;
  /// Memory of hierarchies, vertices and maps, and what building them took.
  virtual std::size_t bytes() const = 0;
  virtual double build_ms() const = 0;
};

/// Null where the program was built without Embree, or an instance is on a path or wraps otherwise
/// than in a loop: those are not measured. The stage must outlive it.
std::unique_ptr<PeerSceneRays> make_embree_scene_rays(const Stage& stage, PeerMode mode);

}  // namespace mdk
