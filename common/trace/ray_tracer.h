// RayTracer: what a model's single rays go through, made once and valid at every time. RayQuery is
// its public face; scenes call it for each character that a ray enters.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "common/motion/model.h"
#include "common/trace/kernels/ray_kernels.h"
#include "mdk/ray_query.h"

namespace mdk {

/// Safe to use from many threads at once; the model must outlive it.
class RayTracer {
 public:
  /// Cost: O(segments * T log T); runs in parallel.
  /// `max_pose_bytes`: what decoded key poses may take; two of them are kept in any case.
  explicit RayTracer(const ModelView& model,
                     std::size_t max_pose_bytes = RayQueryOptions().max_pose_bytes);
  ~RayTracer();
  RayTracer(const RayTracer&) = delete;
  RayTracer& operator=(const RayTracer&) = delete;

  const ModelView& model() const;
  /// Whether `time` is one of the model's; only such times may be traced at.
  bool has_time(const KeyInterval& time) const;

  /// What the ray hits at its own time, brute force's to the bit; with kAny, some hit if there is
  /// one. A ray that has no direction or is not finite hits nothing. Allocates nothing, once the
  /// keys it needs are there.
  QueryHit trace(const QueryRay& ray, const KeyInterval& time, RayAim aim) const;

  /// The same for many rays, each at its own time: hits[i] is that of rays[i] at times[i].
  void trace(const QueryRay* rays, const KeyInterval* times, RayAim aim, QueryHit* hits,
             std::size_t count) const;

  // For other questions that go down the same hierarchies (mesh_queries.h, surface.h).
  const RayModel& rays() const;
  /// The segment whose hierarchies hold at one of the model's times.
  std::uint32_t segment_at(const KeyInterval& time) const;

  /// What it holds now, moments included.
  std::size_t bytes() const;

 private:
  friend class RayMoment;
  friend class HeldVertices;
  struct Data;
  std::unique_ptr<Data> data_;
};

/// Where the vertices are at a time, by their numbers in the model, while this lives. A thread may
/// hold one time, and trace none meanwhile. Cost: O(1), but decoding keys that are not there; the
/// first one of a tracer O(vertices).
class HeldVertices {
 public:
  HeldVertices(const RayTracer& tracer, const KeyInterval& time);
  ~HeldVertices();
  HeldVertices(const HeldVertices&) = delete;
  HeldVertices& operator=(const HeldVertices&) = delete;

  Vec3f position(std::uint32_t vertex) const { return source_.position(places_[vertex]); }
  /// From the first key to the second.
  Vec3d moved(std::uint32_t vertex) const {
    const std::uint32_t i = places_[vertex];
    return to_double(source_.to[i]) - to_double(source_.from[i]);
  }
  /// For kernels: vertices of a triangle as they stand in source().
  const VertexSource& source() const { return source_; }
  Triangle placed(const Triangle& t) const {
    return {{places_[t.v[0]], places_[t.v[1]], places_[t.v[2]]}};
  }

 private:
  const RayTracer& tracer_;
  const KeyInterval time_;
  VertexSource source_;
  const std::uint32_t* places_;
};

/// One time of a tracer, for many rays: the first ones are traced as at a time of their own; when
/// there were enough of them for it to pay, the one that comes next poses the model and refits one
/// hierarchy over it. Safe to use from many threads at once; the tracer must outlive it.
class RayMoment {
 public:
  RayMoment(const RayTracer& tracer, const KeyInterval& time);
  ~RayMoment();
  RayMoment(const RayMoment&) = delete;
  RayMoment& operator=(const RayMoment&) = delete;

  /// RayTracer::trace() at this time, to the bit.
  QueryHit trace(const QueryRay& ray, RayAim aim) const;

 private:
  struct Posed;
  const Posed* make_posed() const;

  const RayTracer& tracer_;
  const KeyInterval time_;
  mutable std::atomic<std::uint32_t> rays_ = 0;
  mutable std::atomic<const Posed*> posed_ = nullptr;
};

}  // namespace mdk
