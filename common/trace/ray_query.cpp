// The public face of RayTracer, and the checks of what programs pass.
#include "mdk/ray_query.h"

#include <cmath>
#include <string>
#include <utility>

#include "common/base/parallel.h"
#include "common/motion/model_handle.h"
#include "common/trace/mesh_queries.h"
#include "common/trace/ray_tracer.h"
#include "common/trace/surface.h"
#include "mdk/error.h"

namespace mdk {
namespace {

static_assert(kNoTriangle == kNoHit);

constexpr std::size_t kRaysPerChunk = 64;

}  // namespace

struct RayQuery::State {
  State(const Model& m, const RayQueryOptions& options)
      : handle(m), tracer(ModelHandle::view(handle), options.max_pose_bytes) {}

  /// Throws Error (kUsage) for a time that the model does not have.
  void require_time(const KeyInterval& at) const {
    if (tracer.has_time(at)) {
      if (at.key0 == at.key1 || tracer.model().holds_between_keys) return;
      throw Error(ErrorCode::kUsage,
                  "a ray's time lies between keys, where the model's boxes do not hold: ask at a "
                  "key, or bake it with --between-keys on");
    }
    throw Error(ErrorCode::kUsage, "a ray's time is none of the model's: keys " +
                                       std::to_string(at.key0) + " and " + std::to_string(at.key1));
  }
  QueryHit trace(const QueryRay& ray, const KeyInterval& at, RayAim aim) const {
    require_time(at);
    return tracer.trace(ray, at, aim);
  }

  const Model handle;  ///< keeps the model alive
  RayTracer tracer;
  Surfaces surfaces{tracer};
};

struct QueryMoment::Data {
  Data(std::shared_ptr<const void> state, const RayTracer& tracer, const KeyInterval& time)
      : query(std::move(state)), moment(tracer, time) {}

  std::shared_ptr<const void> query;  ///< the state that it is of
  RayMoment moment;
};
QueryMoment::QueryMoment(std::shared_ptr<const Data> data) : data_(std::move(data)) {}

namespace {

template <class State, class Moment>
void require_own(const State& state, const Moment& moment) {
  if (moment.query.get() != &state)
    throw Error(ErrorCode::kUsage, "the moment was prepared by another ray query");
}

}  // namespace

RayQuery::RayQuery(const Model& model, const RayQueryOptions& options)
    : state_(std::make_shared<const State>(model, options)) {}

QueryHit RayQuery::closest_hit(const QueryRay& ray, const KeyInterval& time) const {
  return state_->trace(ray, time, RayAim::kClosest);
}
bool RayQuery::any_hit(const QueryRay& ray, const KeyInterval& time) const {
  return state_->trace(ray, time, RayAim::kAny).is_hit();
}
QueryHit RayQuery::closest_hit(const QueryRay& ray, const QueryMoment& moment) const {
  require_own(*state_, *moment.data_);
  return moment.data_->moment.trace(ray, RayAim::kClosest);
}
bool RayQuery::any_hit(const QueryRay& ray, const QueryMoment& moment) const {
  require_own(*state_, *moment.data_);
  return moment.data_->moment.trace(ray, RayAim::kAny).is_hit();
}

QueryMoment RayQuery::prepare(const KeyInterval& time) const {
  state_->require_time(time);
  return QueryMoment(std::make_shared<const QueryMoment::Data>(state_, state_->tracer, time));
}

void RayQuery::closest_hits(const QueryRay* rays, const KeyInterval* times, QueryHit* hits,
                            std::size_t count) const {
  parallel_chunks(count, kRaysPerChunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) state_->require_time(times[i]);
    state_->tracer.trace(rays + begin, times + begin, RayAim::kClosest, hits + begin, end - begin);
  });
}

void RayQuery::any_hits(const QueryRay* rays, const KeyInterval* times, std::uint8_t* hits,
                        std::size_t count) const {
  parallel_chunks(count, kRaysPerChunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) state_->require_time(times[i]);
    QueryHit some[kRaysPerChunk];
    state_->tracer.trace(rays + begin, times + begin, RayAim::kAny, some, end - begin);
    for (std::size_t i = begin; i < end; ++i) hits[i] = some[i - begin].is_hit() ? 1 : 0;
  });
}

std::vector<QueryHit> RayQuery::all_hits(const QueryRay& ray, const KeyInterval& time) const {
  state_->require_time(time);
  std::vector<QueryHit> hits;
  find_all_hits(state_->tracer, ray, time, hits);
  return hits;
}

QueryHit RayQuery::closest_point(const Vec3f& point, float radius, const KeyInterval& time) const {
  state_->require_time(time);
  if (std::isnan(radius)) throw Error(ErrorCode::kUsage, "the radius is not a number");
  if (!std::isfinite(point.x) || !std::isfinite(point.y) || !std::isfinite(point.z))
    throw Error(ErrorCode::kUsage, "the point is not finite");
  return find_closest_point(state_->tracer, point, radius, time);
}

Surface RayQuery::surface(const QueryHit& hit, const KeyInterval& time, SurfaceParts parts) const {
  state_->require_time(time);
  if (hit.triangle >= state_->tracer.model().triangle_count())
    throw Error(ErrorCode::kUsage, "the hit is of no triangle of the model");
  return state_->surfaces.at(hit, time, parts);
}

std::size_t RayQuery::bytes() const { return state_->tracer.bytes(); }

}  // namespace mdk
