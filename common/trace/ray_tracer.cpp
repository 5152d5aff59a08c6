#include "common/trace/ray_tracer.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "common/base/parallel.h"
#include "common/trace/query_keys.h"
#include "common/trace/ray_blocks.h"
#include "common/trace/world_tree.h"

namespace mdk {
namespace {

constexpr std::uint32_t kNowhere = 0xffffffff;

/// Of each cluster, in its basis, at all times.
std::vector<Aabb> local_bounds(const ModelView& model) {
  std::vector<Aabb> bounds(model.cluster_count());
  for (std::uint32_t s = 0; s < model.segment_count(); ++s)
    for (std::size_t c = 0; c < bounds.size(); ++c)
      if (model.clusters[c].triangle_count > 0)
        bounds[c].extend(model.segment_trees(s)[c].local_box);
  return bounds;
}

std::vector<RaySegment> make_segments(const ModelView& model) {
  std::vector<RaySegment> segments;
  for (std::uint32_t s = 0; s < model.segment_count(); ++s) segments.emplace_back(model, s);
  return segments;
}

/// Numbers vertices in the order in which blocks use them, and renames them in the blocks: what a
/// block fetches stands mostly side by side.
std::vector<std::uint32_t> number_vertices(const ModelView& model,
                                           std::vector<RaySegment>& segments) {
  std::vector<std::uint32_t> place(model.vertex_count, kNowhere);
  std::uint32_t next = 0;
  for (RaySegment& segment : segments)
    segment.for_each_vertex([&](std::uint32_t& vertex) {
      if (place[vertex] == kNowhere) place[vertex] = next++;
      vertex = place[vertex];
    });
  return place;
}

/// Which vertex has each place.
std::vector<std::uint32_t> inverted(const std::vector<std::uint32_t>& place) {
  std::vector<std::uint32_t> order(place.size() -
                                   static_cast<std::size_t>(std::ranges::count(place, kNowhere)));
  for (std::uint32_t v = 0; v < place.size(); ++v)
    if (place[v] != kNowhere) order[place[v]] = v;
  return order;
}

}  // namespace

struct RayTracer::Data {
  Data(const ModelView& m, std::size_t max_pose_bytes)
      : model(m),
        segments(make_segments(model)),
        place_of_vertex(number_vertices(model, segments)),
        poses(model, inverted(place_of_vertex), max_pose_bytes),
        top(model),
        maps(model, local_bounds(model)) {
    for (const RaySegment& segment : segments)
      trees.insert(trees.end(), segment.trees().begin(), segment.trees().end());
    find_times();
    world_trees = std::make_unique<std::atomic<const WorldTree*>[]>(model.segment_count());
    for (const Aabb& box : model.key_boxes)
      key_boxes.push_back({{box.lo.x, box.lo.y, box.lo.z, 0}, {box.hi.x, box.hi.y, box.hi.z, 0}});
    rays = {.bounds = model.bounds,
            .center = model.bounds.center(),
            .diagonal = diagonal(model.bounds),
            .clusters = model.cluster_count(),
            .top_nodes = top.nodes(),
            .top_roots = top.roots(),
            .key_boxes = key_boxes.data(),
            .top_boxes = top.boxes(),
            .top_links = top.links(),
            .local_from_world = model.local_from_world.data(),
            .key_maps = maps.maps(),
            .map_kinds = maps.kinds(),
            .local_centers = maps.centers(),
            .trees = trees.data(),
            .poses = &poses};
  }
  ~Data() {
    for (std::uint32_t s = 0; s < model.segment_count(); ++s) delete world_trees[s].load();
  }
  Data(const Data&) = delete;
  Data& operator=(const Data&) = delete;

  void find_times() {
    for (std::uint32_t key = 0; key < model.key_count(); ++key) {
      KeyTimes& times = key_times.emplace_back();
      times.segment_at = mdk::segment_of(model, at_key(key));
      times.has_before = key > 0 && model.clips[clip_of_key(model, key)].first_key != key;
      if (times.has_before) times.segment_before = mdk::segment_of(model, {key - 1, key, 0.5f});
    }
  }

  std::uint32_t segment_of(const KeyInterval& at) const {
    const KeyTimes& times = key_times[at.key1];
    return at.key0 == at.key1 ? times.segment_at : times.segment_before;
  }

  /// The hierarchy in the world that moments of a segment refit; the first one makes it. Without a
  /// lock: a thread that waits for its own loop might come by here again. Two that come at once
  /// make it twice.
  const WorldTree& world_tree(std::uint32_t segment, const VertexSource& source) {
    const WorldTree* found = world_trees[segment].load(std::memory_order_acquire);
    if (found != nullptr) return *found;
    auto made = std::make_unique<const WorldTree>(model, place_of_vertex, source);
    if (world_trees[segment].compare_exchange_strong(found, made.get(),
                                                     std::memory_order_acq_rel)) {
      moment_bytes += made->bytes();
      return *made.release();
    }
    return *found;
  }

  struct KeyTimes {
    std::uint32_t segment_at = 0,
                  segment_before = 0;  ///< of the key, and of the interval before it
    bool has_before = false;
  };

  const ModelView model;
  std::vector<RaySegment> segments;
  std::vector<std::uint32_t> place_of_vertex;  ///< in poses; kNowhere where nothing uses it
  KeyPoses poses;
  TopTree top;
  KeyMaps maps;
  std::vector<RayTree> trees;
  std::vector<KeyTimes> key_times;
  std::vector<KeyBox> key_boxes;
  std::unique_ptr<std::atomic<const WorldTree*>[]> world_trees;  ///< by segment
  std::atomic<std::size_t> moment_bytes = 0;                     ///< theirs, and of moments
  RayModel rays;
};

RayTracer::RayTracer(const ModelView& model, std::size_t max_pose_bytes)
    : data_(std::make_unique<Data>(model, max_pose_bytes)) {}
RayTracer::~RayTracer() = default;

const ModelView& RayTracer::model() const { return data_->model; }

bool RayTracer::has_time(const KeyInterval& at) const {
  if (at.key1 >= data_->key_times.size()) return false;
  if (at.key0 == at.key1) return at.s == 0;
  return at.key0 + 1 == at.key1 && at.s >= 0 && at.s < 1 && data_->key_times[at.key1].has_before;
}

std::size_t RayTracer::bytes() const {
  std::size_t sum = data_->moment_bytes.load() + data_->poses.bytes() + data_->top.bytes() +
                    data_->maps.bytes() + data_->trees.size() * sizeof(RayTree) +
                    data_->place_of_vertex.size() * sizeof(std::uint32_t) +
                    data_->key_times.size() * sizeof(Data::KeyTimes);
  for (const RaySegment& segment : data_->segments) sum += segment.bytes();
  return sum;
}

const RayModel& RayTracer::rays() const { return data_->rays; }

std::uint32_t RayTracer::segment_at(const KeyInterval& time) const {
  return data_->segment_of(time);
}

HeldVertices::HeldVertices(const RayTracer& tracer, const KeyInterval& time)
    : tracer_(tracer),
      time_(time),
      source_(tracer.data_->poses.acquire(time)),
      places_(tracer.data_->poses.places()) {}
HeldVertices::~HeldVertices() { tracer_.data_->poses.release(time_); }

QueryHit RayTracer::trace(const QueryRay& ray, const KeyInterval& time, RayAim aim) const {
  return trace_ray(data_->rays, ray, time, data_->segment_of(time), aim);
}

void RayTracer::trace(const QueryRay* rays, const KeyInterval* times, RayAim aim, QueryHit* hits,
                      std::size_t count) const {
  constexpr std::size_t kSome = 64;
  std::uint32_t segments[kSome];
  for (std::size_t first = 0; first < count; first += kSome) {
    const std::size_t some = std::min(kSome, count - first);
    for (std::size_t i = 0; i < some; ++i) segments[i] = data_->segment_of(times[first + i]);
    trace_rays(data_->rays, rays + first, times + first, segments, aim, hits + first, some);
  }
}

struct RayMoment::Posed {
  PosedWorldTree tree;
  std::size_t bytes;
};

RayMoment::RayMoment(const RayTracer& tracer, const KeyInterval& time)
    : tracer_(tracer), time_(time) {}

RayMoment::~RayMoment() {
  const Posed* posed = posed_.load();
  if (posed == nullptr) return;
  tracer_.data_->moment_bytes -= posed->bytes;
  delete posed;
}

QueryHit RayMoment::trace(const QueryRay& ray, RayAim aim) const {
  const Posed* posed = posed_.load(std::memory_order_acquire);
  if (posed == nullptr) {
    // What refitting takes, in rays; and making the hierarchy first.
    constexpr std::uint32_t kTrianglesPerRay = 64, kNewTrianglesPerRay = 8, kLeastRays = 64;
    const RayTracer::Data& data = *tracer_.data_;
    const bool is_new = data.world_trees[data.segment_of(time_)].load() == nullptr;
    const std::uint32_t enough = kLeastRays + data.model.triangle_count() /
                                                  (is_new ? kNewTrianglesPerRay : kTrianglesPerRay);
    // One ray is the one past them: it makes what the others then use.
    if (rays_.fetch_add(1, std::memory_order_relaxed) != enough)
      return tracer_.trace(ray, time_, aim);
    posed = make_posed();
  }
  return trace_posed(posed->tree.scene(), ray, aim);
}

const RayMoment::Posed* RayMoment::make_posed() const {
  RayTracer::Data& data = *tracer_.data_;
  const VertexSource source = data.poses.acquire(time_);
  PosedWorldTree tree(data.world_tree(data.segment_of(time_), source), source);
  data.poses.release(time_);
  const std::size_t bytes = tree.bytes();
  const Posed* posed = new Posed{std::move(tree), bytes};
  data.moment_bytes += bytes;
  posed_.store(posed, std::memory_order_release);
  return posed;
}

}  // namespace mdk
