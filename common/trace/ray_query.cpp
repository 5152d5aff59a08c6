// How a ray goes through a model (docs/ray-queries.md): the clusters' boxes at its time, nearest
// first, then each one's hierarchy; and through all triangles, which is what that is judged by.
#include "mdk/ray_query.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/base/parallel.h"
#include "common/math/affine3.h"
#include "common/motion/model_handle.h"
#include "common/trace/brute_force.h"
#include "common/trace/cluster_trees.h"
#include "common/trace/query_keys.h"
#include "mdk/error.h"

namespace mdk {
namespace {

static_assert(kNoTriangle == kNoHit);

constexpr std::size_t kRaysPerChunk = 64;

bool is_finite(const Vec3f& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// The largest component of a direction brought near 1 by a power of two, which rounds nothing;
/// t then counts in other lengths, so bounds and results are scaled likewise.
struct ScaledRay {
  WorldRay ray;
  float t_scale = 1;  ///< from the caller's t to ours
  bool usable = false;

  explicit ScaledRay(const QueryRay& q) {
    const float longest =
        std::max({std::abs(q.direction.x), std::abs(q.direction.y), std::abs(q.direction.z)});
    usable = is_finite(q.origin) && is_finite(q.direction) && longest > 0 && q.t_max > q.t_min;
    if (!usable) return;
    const int exponent = std::clamp(std::ilogb(longest), -120, 120);
    t_scale = std::ldexp(1.0f, exponent);
    ray = {to_double(q.origin), to_double(q.direction) * std::ldexp(1.0, -exponent),
           q.t_min * t_scale};
  }

  RayHit nothing_yet(float t_max) const {
    RayHit hit;
    hit.t = t_max * t_scale;
    return hit;
  }
  QueryHit in_callers_lengths(const RayHit& hit) const {
    if (hit.triangle == kNoHit) return {};
    return {hit.t / t_scale, hit.triangle, hit.bary1, hit.bary2};
  }
};

/// The farthest any point of the model may be from the ray's origin, and what the triangle test
/// may be off by at that distance.
double world_slack(const ModelView& model, const Vec3d& origin) {
  const Vec3d center = to_double(model.bounds.center());
  const double reach = length(center - origin) + static_cast<double>(diagonal(model.bounds));
  return reach * 0x1p-19;
}

/// The hierarchies of a time segment's clusters, and the boxes around each, in local bases.
struct SegmentTrees {
  ClusterTrees trees;
  std::vector<Aabb> bounds;  ///< K, empty for clusters without triangles

  SegmentTrees(const ModelView& model, std::uint32_t segment)
      : trees(build_cluster_trees(model, segment)) {
    for (const WideBvh& tree : trees.trees)
      bounds.push_back(tree.nodes.empty() ? Aabb{} : tree.nodes[0].box());
  }
};

/// What rays at one time share: the clusters' maps and boxes. Vertices between keys are not posed:
/// a ray interpolates those it needs.
struct MomentParts {
  const SegmentTrees& segment;
  VertexSource vertices;
  MovingBoxes boxes;
  std::span<const Affine3f> from, to;
  float s;
  std::vector<Affine3d>
      maps;  ///< local_from_world, by cluster; none: each ray makes those it needs

  Affine3d map_of(std::uint32_t c) const {
    return maps.empty() ? interpolate(from[c], to[c], s) : maps[c];
  }
};

}  // namespace

struct QueryMoment::Data {
  std::shared_ptr<const void> query;  ///< the state that the parts point into
  MomentParts parts;
};
QueryMoment::QueryMoment(std::shared_ptr<const Data> data) : data_(std::move(data)) {}

struct RayQuery::State {
  explicit State(const Model& m)
      : handle(m), model(ModelHandle::view(handle)), poses(model), boxes(model) {
    for (std::uint32_t s = 0; s < model.segment_count(); ++s) segments.emplace_back(model, s);
  }

  /// Throws Error (kUsage) for a time that the model does not have.
  MomentParts moment_at(const KeyInterval& at) const {
    bool is_known = at.key1 < model.key_count();
    if (at.key0 == at.key1) {
      is_known = is_known && at.s == 0;
    } else {
      is_known = is_known && at.key0 + 1 == at.key1 && at.s >= 0 && at.s < 1 &&
                 model.clips[clip_of_key(model, at.key1)].first_key != at.key1;
    }
    if (!is_known) {
      throw Error(ErrorCode::kUsage, "a ray's time is none of the model's: keys " +
                                         std::to_string(at.key0) + " and " +
                                         std::to_string(at.key1));
    }
    if (at.key0 != at.key1 && !model.holds_between_keys) {
      throw Error(ErrorCode::kUsage,
                  "a ray's time lies between keys, where the model's boxes do not hold: ask at a "
                  "key, or bake it with --between-keys on");
    }
    return {segments[segment_of(model, at)],
            poses.at(at),
            boxes.at(at),
            model.key_maps(at.key0),
            model.key_maps(at.key1),
            at.s,
            {}};
  }

  const MomentParts& parts_of(const QueryMoment::Data& moment) const {
    if (moment.query.get() != this)
      throw Error(ErrorCode::kUsage, "the moment was prepared by another ray query");
    return moment.parts;
  }

  /// Clusters whose boxes the ray enters come nearest first.
  RayHit trace(const ScaledRay& scaled, float t_max, const MomentParts& moment, RayAim aim) const {
    RayHit hit = scaled.nothing_yet(t_max);
    const WorldRay& ray = scaled.ray;
    const double slack = world_slack(model, ray.origin);
    const BoxRay world = make_box_ray(ray, Affine3d{}, model.bounds, slack);
    thread_local std::vector<EnteredBox> entered;
    entered.resize(std::max(entered.size(), moment.boxes.count));
    const std::size_t count = enter_boxes(world, moment.boxes, hit.t, entered.data());
    const ClusterTrees& trees = moment.segment.trees;
    for (std::size_t i = 0; i < count && !(entered[i].enter > hit.t); ++i) {
      const std::uint32_t c = entered[i].box;
      const std::vector<WideBvhNode>& nodes = trees.trees[c].nodes;
      if (nodes.empty()) continue;
      const BoxRay local = make_box_ray(ray, moment.map_of(c), moment.segment.bounds[c], slack);
      intersect(ray, local, {nodes, trees.blocks_of(c), moment.vertices}, aim, hit);
      if (aim == RayAim::kAny && hit.triangle != kNoHit) break;
    }
    return hit;
  }

  QueryHit closest(const QueryRay& ray, const MomentParts& moment) const {
    const ScaledRay scaled(ray);
    if (!scaled.usable) return {};
    return scaled.in_callers_lengths(trace(scaled, ray.t_max, moment, RayAim::kClosest));
  }
  bool any(const QueryRay& ray, const MomentParts& moment) const {
    const ScaledRay scaled(ray);
    return scaled.usable && trace(scaled, ray.t_max, moment, RayAim::kAny).triangle != kNoHit;
  }

  const Model handle;  ///< keeps the model alive
  const ModelView& model;
  KeyPoses poses;
  BoxColumns boxes;
  std::vector<SegmentTrees> segments;
};

RayQuery::RayQuery(const Model& model) : state_(std::make_shared<const State>(model)) {}

QueryHit RayQuery::closest_hit(const QueryRay& ray, const KeyInterval& time) const {
  return state_->closest(ray, state_->moment_at(time));
}
bool RayQuery::any_hit(const QueryRay& ray, const KeyInterval& time) const {
  return state_->any(ray, state_->moment_at(time));
}
QueryHit RayQuery::closest_hit(const QueryRay& ray, const QueryMoment& moment) const {
  return state_->closest(ray, state_->parts_of(*moment.data_));
}
bool RayQuery::any_hit(const QueryRay& ray, const QueryMoment& moment) const {
  return state_->any(ray, state_->parts_of(*moment.data_));
}

QueryMoment RayQuery::prepare(const KeyInterval& time) const {
  MomentParts parts = state_->moment_at(time);
  for (std::uint32_t c = 0; c < state_->model.cluster_count(); ++c)
    parts.maps.push_back(interpolate(parts.from[c], parts.to[c], time.s));
  return QueryMoment(
      std::make_shared<const QueryMoment::Data>(QueryMoment::Data{state_, std::move(parts)}));
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

QueryHit brute_force_closest_hit(const ModelView& model, const QueryRay& ray,
                                 const KeyInterval& at) {
  PosedMesh mesh(model);
  mesh.set_time(at);
  return brute_force_closest_hit(mesh, ray);
}

QueryHit brute_force_closest_hit(const PosedMesh& mesh, const QueryRay& ray) {
  const ScaledRay scaled(ray);
  if (!scaled.usable) return {};
  RayHit hit = scaled.nothing_yet(ray.t_max);
  const ModelView& model = mesh.model();
  const VertexSource vertices{mesh.positions().data(), mesh.positions().data(), 0};
  TriangleBlock block;
  for (std::uint32_t t = 0; t < model.triangle_count(); ++t) {
    block.push(t, model.triangles[t]);
    if (block.count < kBlockTriangles && t + 1 < model.triangle_count()) continue;
    block.pad();
    intersect(scaled.ray, {}, {{}, {&block, 1}, vertices}, RayAim::kClosest, hit);
    block = {};
  }
  return scaled.in_callers_lengths(hit);
}

}  // namespace mdk
