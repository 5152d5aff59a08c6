#include "common/trace/ray_query.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <vector>

#include "common/base/parallel.h"
#include "common/math/affine_path.h"
#include "common/trace/cluster_trees.h"
#include "common/trace/key_poses.h"

namespace mdk {
namespace {

constexpr std::size_t kRaysPerChunk = 64;

bool is_finite(const Vec3f& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

VertexSource vertices_at(const KeyPoses& poses, const KeyInterval& at) {
  return {poses.at(at.key0), poses.at(at.key1), at.key0 == at.key1 ? 0.0f : at.s};
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
  QueryHit in_callers_lengths(RayHit hit) const {
    if (hit.triangle == kNoHit) return {};
    hit.t /= t_scale;
    return hit;
  }
};

/// The farthest any point of the model may be from the ray's origin, and what the triangle test
/// may be off by at that distance.
double world_slack(const Model& model, const Vec3d& origin) {
  const Vec3d center = to_double(model.bounds.center());
  const double reach = length(center - origin) + static_cast<double>(model.bounds.diagonal());
  return reach * 0x1p-19;
}

/// A cluster whose world box a ray meets.
struct Candidate {
  std::uint32_t cluster;
  float enter;
};

}  // namespace

class QueryMoment {
 public:
  KeyInterval at;
  VertexSource vertices;
  const ClusterTrees* trees = nullptr;
  std::vector<Aabb> world_boxes;
  std::vector<Affine3d> local_from_world;
};

struct RayQuery::State {
  explicit State(const Model& m) : model(m), poses(m) {
    for (std::uint32_t s = 0; s < m.segment_count(); ++s)
      segments.push_back(build_cluster_trees(m, s));
  }

  /// Clusters whose boxes the ray meets are entered nearest first. `box_of` and `map_of` give a
  /// cluster's world box and map at the ray's time.
  template <class BoxOf, class MapOf>
  void trace(const ScaledRay& scaled, const ClusterTrees& trees, const VertexSource& vertices,
             RayAim aim, RayHit& hit, const BoxOf& box_of, const MapOf& map_of) const {
    const WorldRay& ray = scaled.ray;
    const double slack = world_slack(model, ray.origin);
    const BoxRay world = make_box_ray(ray.origin, ray.direction, Affine3d{}, model.bounds, slack);
    thread_local std::vector<Candidate> met;
    met.clear();
    for (std::uint32_t c = 0; c < model.cluster_count(); ++c) {
      const Aabb box = box_of(c);
      if (box.empty() || trees.trees[c].nodes.empty()) continue;
      const float enter = enter_box(world, box, hit.t);
      if (enter <= hit.t && std::isfinite(enter)) met.push_back({c, enter});
    }
    std::sort(met.begin(), met.end(),
              [](const Candidate& a, const Candidate& b) { return a.enter < b.enter; });
    for (const Candidate& candidate : met) {
      if (candidate.enter > hit.t) break;
      const std::uint32_t c = candidate.cluster;
      const WideBvh& tree = trees.trees[c];
      const Aabb bounds = tree.nodes[0].box();
      const BoxRay local = make_box_ray(ray.origin, ray.direction, map_of(c), bounds, slack);
      intersect_cluster(
          ray, local, {tree.nodes, trees.blocks.data() + trees.first_leaf[c], vertices}, aim, hit);
      if (aim == RayAim::kAny && hit.triangle != kNoHit) return;
    }
  }

  RayHit trace_at(const ScaledRay& scaled, float t_max, const KeyInterval& at, RayAim aim) const {
    RayHit hit = scaled.nothing_yet(t_max);
    const std::span<const Affine3f> from = model.key_maps(at.key0), to = model.key_maps(at.key1);
    trace(
        scaled, segments[segment_of(model, at)], vertices_at(poses, at), aim, hit,
        [&](std::uint32_t c) { return cluster_world_box(model, c, at); },
        [&](std::uint32_t c) { return interpolate(from[c], to[c], at.s); });
    return hit;
  }

  RayHit trace_at(const ScaledRay& scaled, float t_max, const QueryMoment& moment,
                  RayAim aim) const {
    RayHit hit = scaled.nothing_yet(t_max);
    trace(
        scaled, *moment.trees, moment.vertices, aim, hit,
        [&](std::uint32_t c) { return moment.world_boxes[c]; },
        [&](std::uint32_t c) { return moment.local_from_world[c]; });
    return hit;
  }

  template <class Moment>
  QueryHit closest(const QueryRay& ray, const Moment& moment) const {
    const ScaledRay scaled(ray);
    if (!scaled.usable) return {};
    return scaled.in_callers_lengths(trace_at(scaled, ray.t_max, moment, RayAim::kClosest));
  }
  template <class Moment>
  bool any(const QueryRay& ray, const Moment& moment) const {
    const ScaledRay scaled(ray);
    return scaled.usable && trace_at(scaled, ray.t_max, moment, RayAim::kAny).triangle != kNoHit;
  }

  const Model& model;
  KeyPoses poses;
  std::vector<ClusterTrees> segments;
};

RayQuery::RayQuery(const Model& model) : state_(std::make_unique<State>(model)) {}
RayQuery::~RayQuery() = default;

QueryHit RayQuery::closest_hit(const QueryRay& ray, const KeyInterval& at) const {
  return state_->closest(ray, at);
}
bool RayQuery::any_hit(const QueryRay& ray, const KeyInterval& at) const {
  return state_->any(ray, at);
}
QueryHit RayQuery::closest_hit(const QueryRay& ray, const QueryMoment& moment) const {
  return state_->closest(ray, moment);
}
bool RayQuery::any_hit(const QueryRay& ray, const QueryMoment& moment) const {
  return state_->any(ray, moment);
}

std::shared_ptr<const QueryMoment> RayQuery::prepare(const KeyInterval& at) const {
  const Model& model = state_->model;
  auto moment = std::make_shared<QueryMoment>();
  moment->at = at;
  moment->vertices = vertices_at(state_->poses, at);
  moment->trees = &state_->segments[segment_of(model, at)];
  const std::span<const Affine3f> from = model.key_maps(at.key0), to = model.key_maps(at.key1);
  for (std::uint32_t c = 0; c < model.cluster_count(); ++c) {
    moment->world_boxes.push_back(cluster_world_box(model, c, at));
    moment->local_from_world.push_back(interpolate(from[c], to[c], at.s));
  }
  return moment;
}

void RayQuery::closest_hits(std::span<const QueryRay> rays, std::span<const KeyInterval> times,
                            std::span<QueryHit> hits) const {
  assert(rays.size() == times.size() && rays.size() == hits.size());
  parallel_chunks(rays.size(), kRaysPerChunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) hits[i] = closest_hit(rays[i], times[i]);
  });
}

void RayQuery::any_hits(std::span<const QueryRay> rays, std::span<const KeyInterval> times,
                        std::span<std::uint8_t> hits) const {
  assert(rays.size() == times.size() && rays.size() == hits.size());
  parallel_chunks(rays.size(), kRaysPerChunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) hits[i] = any_hit(rays[i], times[i]);
  });
}

std::size_t RayQuery::structure_bytes() const {
  std::size_t bytes = state_->poses.bytes();
  for (const ClusterTrees& segment : state_->segments) bytes += segment.bytes();
  return bytes;
}

QueryHit brute_force_closest_hit(const Model& model, const QueryRay& ray, const KeyInterval& at) {
  PosedMesh mesh(model);
  mesh.set_time(at);
  return brute_force_closest_hit(mesh, ray);
}

QueryHit brute_force_closest_hit(const PosedMesh& mesh, const QueryRay& ray) {
  const ScaledRay scaled(ray);
  if (!scaled.usable) return {};
  RayHit hit = scaled.nothing_yet(ray.t_max);
  const Model& model = mesh.model();
  const VertexSource vertices{mesh.positions().data(), mesh.positions().data(), 0};
  TriangleBlock block;
  for (std::uint32_t t = 0; t < model.triangle_count(); ++t) {
    block.push(t, model.triangles[t]);
    if (block.count < kBlockTriangles && t + 1 < model.triangle_count()) continue;
    block.pad();
    intersect_blocks(scaled.ray, {&block, 1}, vertices, hit);
    block = {};
  }
  return scaled.in_callers_lengths(hit);
}

}  // namespace mdk
