#include "common/trace/ray_tracer.h"

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include "common/math/affine3.h"
#include "common/trace/cluster_trees.h"
#include "common/trace/query_keys.h"
#include "common/trace/scaled_ray.h"

namespace mdk {
namespace {

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

struct RayTracer::Data {
  explicit Data(const ModelView& m) : model(m), poses(model), boxes(model) {
    for (std::uint32_t s = 0; s < model.segment_count(); ++s) segments.emplace_back(model, s);
  }

  MomentParts moment_at(const KeyInterval& at) const {
    return {segments[segment_of(model, at)],
            poses.at(at),
            boxes.at(at),
            model.key_maps(at.key0),
            model.key_maps(at.key1),
            at.s,
            {}};
  }

  /// Clusters whose boxes the ray enters come nearest first.
  RayHit trace(const ScaledRay& scaled, const MomentParts& moment, RayAim aim) const {
    RayHit hit = scaled.nothing_yet();
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

  const ModelView model;
  KeyPoses poses;
  BoxColumns boxes;
  std::vector<SegmentTrees> segments;
};

RayTracer::RayTracer(const ModelView& model) : data_(std::make_unique<Data>(model)) {}
RayTracer::~RayTracer() = default;

const ModelView& RayTracer::model() const { return data_->model; }

bool RayTracer::has_time(const KeyInterval& at) const {
  const ModelView& model = data_->model;
  if (at.key1 >= model.key_count()) return false;
  if (at.key0 == at.key1) return at.s == 0;
  return at.key0 + 1 == at.key1 && at.s >= 0 && at.s < 1 &&
         model.clips[clip_of_key(model, at.key1)].first_key != at.key1;
}

std::size_t RayTracer::bytes() const {
  std::size_t sum = data_->poses.bytes() + data_->boxes.bytes();
  for (const SegmentTrees& segment : data_->segments) sum += segment.trees.bytes();
  return sum;
}

QueryHit RayTracer::trace(const QueryRay& ray, const KeyInterval& time, RayAim aim) const {
  const ScaledRay scaled(ray);
  if (!scaled.usable) return {};
  return scaled.in_callers_lengths(data_->trace(scaled, data_->moment_at(time), aim));
}

}  // namespace mdk
