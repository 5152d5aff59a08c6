// The public face of RayTracer, and the checks of what programs pass.
#include "mdk/ray_query.h"

#include <string>
#include <utility>

#include "common/base/parallel.h"
#include "common/motion/model_handle.h"
#include "common/trace/ray_tracer.h"
#include "mdk/error.h"

namespace mdk {
namespace {

static_assert(kNoTriangle == kNoHit);

constexpr std::size_t kRaysPerChunk = 64;

}  // namespace

struct RayQuery::State {
  explicit State(const Model& m) : handle(m), tracer(ModelHandle::view(handle)) {}

  /// Throws Error (kUsage) for a time that the model does not have.
  void require_time(const KeyInterval& at) const {
    if (tracer.has_time(at)) return;
    throw Error(ErrorCode::kUsage, "a ray's time is none of the model's: keys " +
                                       std::to_string(at.key0) + " and " + std::to_string(at.key1));
  }
  QueryHit trace(const QueryRay& ray, const KeyInterval& at, RayAim aim) const {
    require_time(at);
    return tracer.trace(ray, at, aim);
  }

  const Model handle;  ///< keeps the model alive
  RayTracer tracer;
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

RayQuery::RayQuery(const Model& model) : state_(std::make_shared<const State>(model)) {}

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
    for (std::size_t i = begin; i < end; ++i) hits[i] = closest_hit(rays[i], times[i]);
  });
}

void RayQuery::any_hits(const QueryRay* rays, const KeyInterval* times, std::uint8_t* hits,
                        std::size_t count) const {
  parallel_chunks(count, kRaysPerChunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) hits[i] = any_hit(rays[i], times[i]);
  });
}

std::size_t RayQuery::bytes() const { return state_->tracer.bytes(); }

}  // namespace mdk
