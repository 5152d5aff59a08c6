#include "common/trace/scene_tracer.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/motion/model_handle.h"
#include "common/trace/brute_force.h"
#include "common/trace/kernels/instance_kernel.h"
#include "common/trace/scaled_ray.h"

namespace mdk {
namespace {

QueryRay mapped_ray(const Affine3d& model_from_world, const QueryRay& ray) {
  return {map_point(model_from_world, ray.origin), map_vector(model_from_world, ray.direction),
          ray.t_min, ray.t_max};
}

/// Whether a hit of an instance comes before the one there is.
bool is_closer(float t, std::uint32_t instance, const SceneHit& than) {
  return t < than.t || (t == than.t && instance < than.instance);
}

SceneHit hit_of(const Stage& stage, std::uint32_t instance, const QueryHit& hit) {
  return {hit.t, instance, hit.triangle, hit.bary1, hit.bary2, stage.scene().labels[instance].id};
}

}  // namespace

SceneTracer::SceneTracer(const Stage& stage,
                         std::span<const std::shared_ptr<const RayTracer>> tracers)
    : stage_(&stage), trees_(stage) {
  for (std::size_t m = 0; m < stage.models().size(); ++m)
    tracers_.push_back(
        m < tracers.size() && tracers[m] != nullptr
            ? tracers[m]
            : std::make_shared<const RayTracer>(ModelHandle::view(stage.models()[m])));
}

/// One ray on its way.
class SceneTracer::Walk final : public LeafVisitor {
 public:
  Walk(const SceneTracer& scene, const QueryRay& ray, const ScaledRay& scaled, double time,
       RayAim aim, std::uint32_t mask)
      : scene_(scene),
        stage_(*scene.stage_),
        ray_(ray),
        scaled_(scaled),
        time_(time),
        aim_(aim),
        mask_(mask) {}

  SceneHit run() {
    const Aabb& bounds = scene_.trees_.bounds();
    if (bounds.empty()) return {};
    const WorldRay& world = scaled_.ray;
    const Vec3d center = (to_double(bounds.lo) + to_double(bounds.hi)) * 0.5;
    const double reach =
        length(center - world.origin) + length(to_double(bounds.hi) - to_double(bounds.lo));
    const BoxRay box_ray =
        make_box_ray(world, Affine3d{}, bounds, ray_slack(scene_.trees_.unevenness(), reach));
    end_ = scaled_.nothing_yet().t;
    begin_ = box_ray.t_begin;
    walk_instances(scene_.trees_.standing(), box_ray, end_, *this);
    if (!(end_ < begin_)) walk_instances(scene_.trees_.moving(time_), box_ray, end_, *this);
    return best_;
  }

  float enter(std::uint32_t i) override {
    if (mask_ != kAllInstances && (stage_.scene().labels[i].mask & mask_) == 0) return end_;
    if (!stage_.is_shown(i, time_)) return end_;
    QueryRay local = mapped_ray(stage_.model_from_world(i, time_), ray_);
    local.t_max = std::min(ray_.t_max, best_.t);
    const QueryHit hit =
        scene_.tracers_[stage_.role(i).model]->trace(local, stage_.key_interval(i, time_), aim_);
    if (!hit.is_hit() || (best_.is_hit() && !is_closer(hit.t, i, best_))) return end_;
    best_ = hit_of(stage_, i, hit);
    return end_ = aim_ == RayAim::kAny ? -std::numeric_limits<float>::infinity()
                                       : scaled_.scaled(hit.t);
  }

 private:
  const SceneTracer& scene_;
  const Stage& stage_;
  const QueryRay& ray_;
  const ScaledRay& scaled_;
  double time_;
  RayAim aim_;
  std::uint32_t mask_;
  SceneHit best_;
  float begin_ = 0, end_ = 0;  ///< in the lengths of the scaled ray
};

SceneHit SceneTracer::trace(const QueryRay& ray, double time, RayAim aim,
                            std::uint32_t mask) const {
  const ScaledRay scaled(ray);
  if (!scaled.usable) return {};
  return Walk(*this, ray, scaled, time, aim, mask).run();
}

std::size_t SceneTracer::own_bytes() const { return trees_.bytes(); }

std::size_t SceneTracer::model_bytes() const {
  std::size_t sum = 0;
  for (const auto& tracer : tracers_) sum += tracer->bytes();
  return sum;
}

SceneHit brute_force_closest_hit(const Stage& stage, const QueryRay& ray, double time,
                                 std::uint32_t mask) {
  SceneHit best;
  for (std::uint32_t i = 0; i < stage.instance_count(); ++i) {
    if ((stage.scene().labels[i].mask & mask) == 0 || !stage.is_shown(i, time)) continue;
    const QueryHit hit =
        brute_force_closest_hit(stage.model_of(i), mapped_ray(stage.model_from_world(i, time), ray),
                                stage.key_interval(i, time));
    if (hit.is_hit() && is_closer(hit.t, i, best)) best = hit_of(stage, i, hit);
  }
  return best;
}

}  // namespace mdk
