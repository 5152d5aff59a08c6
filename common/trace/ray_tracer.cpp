#include "common/trace/ray_tracer.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "common/base/parallel.h"
#include "common/trace/query_keys.h"
#include "common/trace/ray_blocks.h"
#include "common/trace/scaled_ray.h"

namespace mdk {
namespace {

/// Of each cluster, in its basis, at all times.
std::vector<Aabb> local_bounds(const ModelView& model) {
  std::vector<Aabb> bounds(model.cluster_count());
  for (std::uint32_t s = 0; s < model.segment_count(); ++s)
    for (std::size_t c = 0; c < bounds.size(); ++c)
      if (model.clusters[c].triangle_count > 0)
        bounds[c].extend(model.segment_trees(s)[c].local_box);
  return bounds;
}

}  // namespace

struct RayTracer::Data {
  explicit Data(const ModelView& m)
      : model(m), poses(model), top(model), maps(model, local_bounds(model)) {
    for (std::uint32_t s = 0; s < model.segment_count(); ++s) segments.emplace_back(model, s);
    for (const RaySegment& segment : segments)
      trees.insert(trees.end(), segment.trees().begin(), segment.trees().end());
    find_times();
    rays = {.center = model.bounds.center(),
            .diagonal = diagonal(model.bounds),
            .clusters = model.cluster_count(),
            .top_nodes = top.nodes(),
            .top_roots = top.roots(),
            .key_boxes = model.key_boxes.data(),
            .top_boxes = top.boxes(),
            .top_links = top.links(),
            .local_from_world = model.local_from_world.data(),
            .key_maps = maps.maps(),
            .map_kinds = maps.kinds(),
            .local_centers = maps.centers(),
            .trees = trees.data(),
            .poses = &poses};
  }
  Data(const Data&) = delete;
  Data& operator=(const Data&) = delete;

  void find_times() {
    for (std::uint32_t key = 0; key < model.key_count(); ++key) {
      KeyTimes& times = key_times.emplace_back();
      times.segment_at = segment_of(model, at_key(key));
      times.has_before = key > 0 && model.clips[clip_of_key(model, key)].first_key != key;
      if (times.has_before) times.segment_before = segment_of(model, {key - 1, key, 0.5f});
    }
  }

  struct KeyTimes {
    std::uint32_t segment_at = 0, segment_before = 0;  ///< of the key, and of the interval before it
    bool has_before = false;
  };

  const ModelView model;
  KeyPoses poses;
  TopTree top;
  KeyMaps maps;
  std::vector<RaySegment> segments;
  std::vector<RayTree> trees;
  std::vector<KeyTimes> key_times;
  RayModel rays;
};

RayTracer::RayTracer(const ModelView& model) : data_(std::make_unique<Data>(model)) {}
RayTracer::~RayTracer() = default;

const ModelView& RayTracer::model() const { return data_->model; }

bool RayTracer::has_time(const KeyInterval& at) const {
  if (at.key1 >= data_->key_times.size()) return false;
  if (at.key0 == at.key1) return at.s == 0;
  return at.key0 + 1 == at.key1 && at.s >= 0 && at.s < 1 && data_->key_times[at.key1].has_before;
}

const RayModel& RayTracer::rays() const { return data_->rays; }

std::uint32_t RayTracer::segment(const KeyInterval& time) const {
  const Data::KeyTimes& times = data_->key_times[time.key1];
  return time.key0 == time.key1 ? times.segment_at : times.segment_before;
}

std::size_t RayTracer::bytes() const {
  std::size_t sum = data_->poses.bytes() + data_->top.bytes() + data_->maps.bytes() +
                    data_->trees.size() * sizeof(RayTree) +
                    data_->key_times.size() * sizeof(Data::KeyTimes);
  for (const RaySegment& segment : data_->segments) sum += segment.bytes();
  return sum;
}

QueryHit RayTracer::trace(const QueryRay& ray, const KeyInterval& time, RayAim aim) const {
  const ScaledRay scaled(ray);
  if (!scaled.usable) return {};
  RayHit hit = scaled.nothing_yet();
  trace_ray(data_->rays, scaled.ray, time, segment(time), aim, hit);
  return scaled.in_callers_lengths(hit);
}

}  // namespace mdk
