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
  explicit RayTracer(const ModelView& model);
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

  /// For kernels that go the same way: what rays go through, and the segment of a time, one of
  /// has_time().
  const RayModel& rays() const;
  std::uint32_t segment(const KeyInterval& time) const;

  /// What it holds now, moments included.
  std::size_t bytes() const;

 private:
  friend class RayMoment;
  struct Data;
  std::unique_ptr<Data> data_;
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
