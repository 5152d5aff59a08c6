#include "preprocess/boxes/model_assembly.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include "common/base/error.h"
#include "common/base/parallel.h"
#include "common/structures/kd_tree.h"
#include "preprocess/boxes/cost.h"
#include "preprocess/boxes/fuzzy_boxes.h"
#include "preprocess/pose/pose_table.h"

namespace mdk {
namespace {

// How far the time spent on boxes is when the fuzzy ones and those of the clusters are there; the
// boxes of poses come last.
constexpr double kFuzzyBoxes = 0.8, kWorldBoxes = 0.9;

/// `items` has `per_triangle` entries for each triangle, or none; puts them into the order
/// `sources`.
template <class T>
void permute(std::vector<T>& items, std::span<const std::uint32_t> sources,
             std::size_t per_triangle) {
  if (items.empty()) return;
  std::vector<T> sorted(items.size());
  for (std::size_t t = 0; t < sources.size(); ++t)
    std::copy_n(&items[per_triangle * sources[t]], per_triangle, &sorted[per_triangle * t]);
  items = std::move(sorted);
}

/// Appends a segment's boxes as they are stored: in their clusters' local boxes, which are the
/// smallest there are.
void append_fuzzy_boxes(std::span<const Aabb> boxes, ModelStorage& model) {
  for (const Cluster& cluster : model.clusters) {
    const auto own = boxes.subspan(cluster.first_triangle, cluster.triangle_count);
    FuzzyTree& tree = model.fuzzy_trees.emplace_back();
    for (const Aabb& box : own) tree.local_box.extend(box);
    for (const Aabb& box : own) model.fuzzy_boxes.push_back(quantize_outward(box, tree.local_box));
  }
}

/// `boxes`: F * K, key-major.
void set_world_boxes(std::span<const Aabb> boxes, ModelStorage& model) {
  const std::size_t clusters = model.clusters.size();
  model.cluster_world_boxes.reserve(boxes.size());
  for (std::size_t first = 0; first < boxes.size(); first += clusters) {
    const auto of_key = boxes.subspan(first, clusters);
    Aabb& whole = model.key_boxes.emplace_back();
    for (const Aabb& box : of_key) whole.extend(box);
    for (const Aabb& box : of_key)
      model.cluster_world_boxes.push_back(quantize_outward(box, whole));
    model.bounds.extend(whole);
  }
}

/// A segment in stretches that share a key with the next, none of them much work.
std::vector<Segment> stretches_of(const PoseSequence& sequence, const Segment& segment) {
  constexpr std::size_t kPositions = std::size_t{1} << 20, kMaxStretches = 16;
  const std::size_t intervals = segment.last_key - segment.first_key;
  const std::size_t count =
      std::clamp<std::size_t>(intervals * sequence.vertex_count / kPositions, 1,
                              std::clamp<std::size_t>(intervals, 1, kMaxStretches));
  std::vector<Segment> stretches;
  for (std::size_t i = 0; i < count; ++i)
    stretches.push_back(
        {segment.first_key + static_cast<std::uint32_t>(i * intervals / count),
         segment.first_key + static_cast<std::uint32_t>((i + 1) * intervals / count)});
  return stretches;
}

/// fuzzy_boxes of a segment, which tells on the way how many of all intervals between keys are
/// done.
class SegmentBoxes {
 public:
  SegmentBoxes(const PoseSequence& sequence, const Decomposition& decomposition,
               ProgressSink& progress)
      : sequence_(sequence), decomposition_(decomposition), progress_(progress) {}

  std::vector<Aabb> of(const Segment& segment) {
    const KeyMaps& maps = decomposition_.maps;
    const std::vector<Aabb>& pose_space_boxes = decomposition_.pose_space_boxes;
    std::vector<Aabb> boxes(sequence_.triangles.size());
    for (const Segment& stretch : stretches_of(sequence_, segment)) {
      const std::vector<Aabb> more =
          fuzzy_boxes(sequence_, decomposition_.members, maps.local_from_world, stretch,
                      decomposition_.between);
      for (std::size_t t = 0; t < boxes.size(); ++t) boxes[t].extend(more[t]);
      done_ += stretch.last_key - stretch.first_key;
      progress_.report("build", std::min(1.0, done_ / sequence_.key_count()));
    }
    for (std::size_t t = 0; t < pose_space_boxes.size(); ++t) boxes[t].extend(pose_space_boxes[t]);
    return boxes;
  }

 private:
  const PoseSequence& sequence_;
  const Decomposition& decomposition_;
  ProgressSink& progress_;
  double done_ = 0;
};

/// What the cost needs to know about one cluster of the finished model in one segment.
ClusterWork cluster_work(const ModelView& model, std::uint32_t segment, std::size_t cluster,
                         const AreaWeightTable& weights, std::span<const double> model_areas) {
  const Segment& keys = model.segments[segment];
  std::vector<Aabb> world_boxes;
  for (std::uint32_t key = keys.first_key; key <= keys.last_key; ++key)
    world_boxes.push_back(model.world_box(key, cluster));
  ClusterWork work;
  work.weights = weights.mean(cluster, keys.first_key, keys.last_key);
  work.hit_probability =
      mean_hit_probability<float>(world_boxes, model_areas.subspan(keys.first_key));
  for (const Aabb& box : model.cluster_fuzzy_boxes(segment, cluster)) work.fuzzy_boxes.add(box);
  return work;
}

/// S * K, segment-major.
std::vector<ClusterWork> all_work(const ModelView& model, std::span<const double> model_areas) {
  const AreaWeightTable weights(model.local_from_world, model_areas);
  std::vector<ClusterWork> work;
  for (std::uint32_t s = 0; s < model.segments.size(); ++s)
    for (std::size_t c = 0; c < model.clusters.size(); ++c)
      work.push_back(cluster_work(model, s, c, weights, model_areas));
  return work;
}

/// Weights as the tree builder takes them: the largest is 1. Plain areas where they are no use.
AreaWeights tree_weights(const AreaWeights& w) {
  const double largest = std::max({w.xy, w.yz, w.zx});
  if (!(largest > 0) || !std::isfinite(largest)) return {};
  return {w.xy / largest, w.yz / largest, w.zx / largest};
}

/// Into the trees whose local boxes are there. `work`: S * K, segment-major.
void build_fuzzy_trees(ModelStorage& model, std::span<const ClusterWork> work) {
  const std::size_t clusters = model.clusters.size();
  const ModelView view = model.view();
  std::vector<KdTree> trees(work.size());
  parallel_chunks(trees.size(), 1, [&](std::size_t i, std::size_t) {
    KdBuildConfig config = kTriangleTreeConfig;
    config.area = tree_weights(work[i].weights);
    trees[i] = build_kd_tree(
        view.cluster_fuzzy_boxes(static_cast<std::uint32_t>(i / clusters), i % clusters),
        model.clusters[i % clusters].first_triangle, config);
  });
  constexpr std::size_t kMaxLinks = std::numeric_limits<std::uint32_t>::max();
  for (std::size_t i = 0; i < trees.size(); ++i) {
    const KdTree& tree = trees[i];
    if (tree.nodes.size() > kMaxLinks - model.kd_nodes.size() ||
        tree.refs.size() > kMaxLinks - model.kd_refs.size())
      throw Error(ErrorCode::kOverLimit,
                  "the fuzzy kd-trees have more than 2^32 nodes or references: ask for fewer "
                  "segments");
    FuzzyTree& stored = model.fuzzy_trees[i];
    stored.first_node = static_cast<std::uint32_t>(model.kd_nodes.size());
    stored.node_count = static_cast<std::uint32_t>(tree.nodes.size());
    stored.first_ref = static_cast<std::uint32_t>(model.kd_refs.size());
    stored.ref_count = static_cast<std::uint32_t>(tree.refs.size());
    model.kd_nodes.insert(model.kd_nodes.end(), tree.nodes.begin(), tree.nodes.end());
    model.kd_refs.insert(model.kd_refs.end(), tree.refs.begin(), tree.refs.end());
  }
}

/// What takes least room of what there is; a skeleton is of no use without its rig.
PoseStorage stored_poses(PoseSequence& sequence, std::optional<QuantizedPoses> quantized) {
  if (quantized) return {PoseKind::kQuantized, {}, {}, *std::move(quantized)};
  if (sequence.skeleton || rig_is_smallest(sequence))
    return {PoseKind::kRig, {}, *std::move(sequence.rig), {}};
  return {PoseKind::kKeyPositions, std::move(sequence.positions), {}, {}};
}

std::vector<Cluster> cluster_ranges(const ClusterMembers& members) {
  std::vector<Cluster> clusters(members.cluster_count());
  for (std::uint32_t c = 0; c < clusters.size(); ++c)
    clusters[c] = {members.triangle_begin[c],
                   members.triangle_begin[c + 1] - members.triangle_begin[c]};
  return clusters;
}

/// Mean over time: a segment counts by the intervals between keys it has.
double mean_work(std::span<const Segment> segments, std::span<const ClusterWork> work) {
  const std::size_t clusters = work.size() / segments.size();
  double sum = 0, all = 0;
  for (std::size_t s = 0; s < segments.size(); ++s) {
    const double intervals = std::max(1u, segments[s].last_key - segments[s].first_key);
    sum += intervals * expected_work(work.subspan(s * clusters, clusters));
    all += intervals;
  }
  return sum / all;
}

}  // namespace

bool rig_is_smallest(const PoseSequence& sequence) {
  return sequence.rig && sequence.rig->bytes() < sequence.positions.size() * sizeof(Vec3f);
}

double predicted_cost(const ModelView& model) {
  std::vector<double> model_areas;
  for (const Aabb& box : model.key_boxes)
    model_areas.push_back(static_cast<double>(surface_area(box)));
  return mean_work(model.segments, all_work(model, model_areas));
}

AssembledModel assemble_model(PoseSequence sequence, Decomposition decomposition,
                              double boxes_until, ProgressSink& progress) {
  progress.report("build", 0);
  const ClusterMembers& members = decomposition.members;
  AssembledModel result;
  ModelStorage& model = result.model;
  model.rest_key = decomposition.growth.rest_key;
  model.rest_diagonal = diagonal(pose_box(sequence.pose(model.rest_key)));
  model.segments = std::move(decomposition.segments);
  model.holds_between_keys = decomposition.between == BetweenKeys::kBound;
  model.clusters = cluster_ranges(members);
  model.fuzzy_boxes.reserve(model.segments.size() * sequence.triangles.size());
  {
    ProgressPart boxing(progress, 0, boxes_until * kFuzzyBoxes);
    SegmentBoxes boxes(sequence, decomposition, boxing);
    for (const Segment& segment : model.segments) append_fuzzy_boxes(boxes.of(segment), model);
  }
  set_world_boxes(cluster_world_boxes(sequence, members), model);
  progress.report("build", boxes_until * kWorldBoxes);
  model.local_from_world = std::move(decomposition.maps.local_from_world);
  model.vertex_count = sequence.vertex_count;
  model.triangles = std::move(sequence.triangles);

  const std::vector<double> model_areas = pose_box_areas(sequence);
  progress.report("build", boxes_until);
  const std::vector<ClusterWork> work = all_work(model.view(), model_areas);
  result.expected_work = mean_work(model.segments, work);
  build_fuzzy_trees(model, work);

  model.source_triangles = std::move(decomposition.members.triangles);
  permute(model.triangles, model.source_triangles, 1);
  model.appearance = std::move(sequence.appearance);
  permute(model.appearance.triangle_materials, model.source_triangles, 1);
  permute(model.appearance.corner_texcoords, model.source_triangles, 3);
  permute(model.appearance.corner_colors, model.source_triangles, 3);
  model.clips = std::move(sequence.clips);
  model.key_times = std::move(sequence.key_times);
  model.poses = stored_poses(sequence, std::move(decomposition.quantized));
  if (sequence.skeleton) {
    model.skeleton = *std::move(sequence.skeleton);
    model.cluster_bones = std::move(decomposition.bones);
  }
  progress.report("build", 1);
  return result;
}

}  // namespace mdk
