#include "preprocess/model_assembly.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>

#include "common/base/parallel.h"
#include "common/structures/kd_tree_builder.h"
#include "preprocess/fuzzy_boxes.h"

namespace mdk {
namespace {

/// Of a triangle test in units of a traversal step. Low, because a tile tests a leaf's triangles
/// many at a time and knows those it met in other leaves: shallow trees were faster on characters.
constexpr float kTestCost = 0.4f;

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

Aabbd pose_box(const PoseSequence& sequence, std::uint32_t key) {
  Aabbd box;
  for (const Vec3f& v : sequence.pose(key)) box.extend(to_double(v));
  return box;
}

/// What the cost needs to know about one cluster of the finished model.
ClusterWork cluster_work(const ModelStorage& model, std::size_t cluster,
                         std::span<const double> model_areas) {
  const std::size_t clusters = model.clusters.size();
  std::vector<Affine3d> maps;
  double met = 0, keys = 0;
  for (std::size_t key = 0; key < model_areas.size(); ++key) {
    maps.push_back(to_double(model.local_from_world[key * clusters + cluster]));
    if (!(model_areas[key] > 0)) continue;
    met += model.cluster_world_boxes[key * clusters + cluster].surface_area() / model_areas[key];
    keys += 1;
  }
  ClusterWork work;
  work.weights = mean_area_weights(maps, model_areas, {});
  work.hit_probability = keys > 0 ? met / keys : 1;
  const Cluster& c = model.clusters[cluster];
  for (const Aabb& box : std::span(model.fuzzy_boxes).subspan(c.first_triangle, c.triangle_count))
    work.fuzzy_boxes.add(box);
  return work;
}

/// Weights as the tree builder likes them: the largest is 1. Plain areas where they are no use.
AreaWeights tree_weights(const AreaWeights& w) {
  const double largest = std::max({w.xy, w.yz, w.zx});
  if (!(largest > 0) || !std::isfinite(largest)) return {};
  return {w.xy / largest, w.yz / largest, w.zx / largest};
}

void build_fuzzy_trees(ModelStorage& model, std::span<const ClusterWork> work,
                       ProgressSink& progress) {
  std::vector<KdTree> trees(model.clusters.size());
  parallel_chunks(trees.size(), 1, [&](std::size_t c, std::size_t) {
    const Cluster& cluster = model.clusters[c];
    KdBuildConfig config;
    config.area = tree_weights(work[c].weights);
    config.intersect_cost = kTestCost;
    trees[c] = build_kd_tree(
        std::span(model.fuzzy_boxes).subspan(cluster.first_triangle, cluster.triangle_count),
        cluster.first_triangle, config);
  });
  progress.report("build", 0.9);
  for (std::size_t c = 0; c < trees.size(); ++c) {
    Cluster& cluster = model.clusters[c];
    cluster.first_node = static_cast<std::uint32_t>(model.kd_nodes.size());
    cluster.node_count = static_cast<std::uint32_t>(trees[c].nodes.size());
    cluster.first_ref = static_cast<std::uint32_t>(model.kd_refs.size());
    cluster.ref_count = static_cast<std::uint32_t>(trees[c].refs.size());
    model.kd_nodes.insert(model.kd_nodes.end(), trees[c].nodes.begin(), trees[c].nodes.end());
    model.kd_refs.insert(model.kd_refs.end(), trees[c].refs.begin(), trees[c].refs.end());
  }
}

std::vector<Cluster> cluster_ranges(const ClusterMembers& members, std::span<const Aabb> boxes) {
  std::vector<Cluster> clusters(members.cluster_count());
  for (std::uint32_t c = 0; c < clusters.size(); ++c) {
    clusters[c].first_triangle = members.triangle_begin[c];
    clusters[c].triangle_count = members.triangle_begin[c + 1] - members.triangle_begin[c];
    for (const Aabb& box : boxes.subspan(clusters[c].first_triangle, clusters[c].triangle_count))
      clusters[c].local_box.extend(box);
  }
  return clusters;
}

}  // namespace

AssembledModel assemble_model(PoseSequence sequence, const ClusterMembers& members, KeyMaps maps,
                              std::uint32_t rest_key, ProgressSink& progress) {
  progress.report("build", 0);
  AssembledModel result;
  ModelStorage& model = result.model;
  model.vertex_count = sequence.vertex_count;
  model.rest_key = rest_key;
  model.rest_diagonal = pose_box(sequence, rest_key).diagonal();
  model.fuzzy_boxes = fuzzy_boxes(sequence, members, maps.local_from_world);
  model.cluster_world_boxes = cluster_world_boxes(sequence, members);
  for (const Aabb& box : model.cluster_world_boxes) model.bounds.extend(box);
  model.clusters = cluster_ranges(members, model.fuzzy_boxes);
  model.local_from_world = std::move(maps.local_from_world);
  progress.report("build", 0.4);

  std::vector<double> model_areas(sequence.key_count());
  for (std::size_t key = 0; key < model_areas.size(); ++key)
    model_areas[key] = pose_box(sequence, static_cast<std::uint32_t>(key)).surface_area();
  for (std::size_t c = 0; c < model.clusters.size(); ++c)
    result.work.push_back(cluster_work(model, c, model_areas));
  build_fuzzy_trees(model, result.work, progress);

  model.source_triangles = members.triangles;
  model.triangles = std::move(sequence.triangles);
  permute(model.triangles, model.source_triangles, 1);
  model.appearance = std::move(sequence.appearance);
  permute(model.appearance.triangle_materials, model.source_triangles, 1);
  permute(model.appearance.corner_texcoords, model.source_triangles, 3);
  permute(model.appearance.corner_colors, model.source_triangles, 3);
  model.clips = std::move(sequence.clips);
  model.key_times = std::move(sequence.key_times);
  model.key_positions = std::move(sequence.positions);
  progress.report("build", 1);
  return result;
}

}  // namespace mdk
