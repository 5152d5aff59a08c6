#include "preprocess/motion_clusters.h"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include "preprocess/box_alternatives.h"
#include "preprocess/box_growth.h"
#include "preprocess/cluster_growth.h"
#include "preprocess/key_sampling.h"
#include "preprocess/local_frame.h"
#include "preprocess/rest_pose.h"

namespace mdk {
namespace {

// Clusters are grown on few keys, and on few triangles of a large mesh, as long as they are few;
// then on all triangles and as many keys as a budget of entries (keys times vertices) allows.
constexpr std::uint32_t kRoughKeys = 32, kRoughClusters = 32;
constexpr std::size_t kWholeTriangles = 24'000;  // larger meshes are thinned to...
constexpr std::size_t kThinTriangles = 6'000;    // ...so many, which rarely share vertices
constexpr std::size_t kFineEntries = 400'000, kLeastFineKeys = 16;
constexpr std::size_t kRestCandidates = 2;

// The paper's way.
constexpr std::size_t kResidualGrowthEntries = 250'000;
constexpr std::size_t kResidualPolishEntries = 8'000'000;
constexpr LloydOptions kResidualPolish = {.min_gain = 0.002, .max_rounds = 8};

/// Every n-th triangle of a mesh with the vertices they use.
struct ThinnedMesh {
  PoseTable poses;
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> sources;  ///< per triangle, its number in the whole mesh
};

ThinnedMesh thinned(const PoseTable& table, std::span<const Triangle> triangles, std::size_t step) {
  constexpr std::uint32_t kUnused = std::numeric_limits<std::uint32_t>::max();
  ThinnedMesh mesh;
  std::vector<std::uint32_t> number(table.vertex_count, kUnused), vertices;
  for (std::size_t t = 0; t < triangles.size(); t += step) {
    Triangle triangle = triangles[t];
    for (std::uint32_t& v : triangle.v) {
      if (number[v] == kUnused) {
        number[v] = static_cast<std::uint32_t>(vertices.size());
        vertices.push_back(v);
      }
      v = number[v];
    }
    mesh.triangles.push_back(triangle);
    mesh.sources.push_back(static_cast<std::uint32_t>(t));
  }
  mesh.poses.vertex_count = static_cast<std::uint32_t>(vertices.size());
  mesh.poses.unit = table.unit;
  mesh.poses.keys = table.keys;
  mesh.poses.centers = table.centers;
  const std::vector<float>* const from[3] = {&table.x, &table.y, &table.z};
  std::vector<float>* const to[3] = {&mesh.poses.x, &mesh.poses.y, &mesh.poses.z};
  for (int axis = 0; axis < 3; ++axis)
    for (std::uint32_t row = 0; row < table.row_count(); ++row)
      for (const std::uint32_t v : vertices)
        to[axis]->push_back((*from[axis])[table.row_offset(row) + v]);
  return mesh;
}

/// The best of the most promising rest rows by cost; the clustering is fitted to it.
BoxClustering with_best_rest_row(BoxProblem& problem, BoxClustering clustering) {
  const ClusterMembers members =
      make_cluster_members(problem.mesh.triangles, clustering.cluster_of_triangle,
                           clustering.cluster_count(), problem.mesh.poses.vertex_count);
  const std::uint32_t first = problem.measure.rest_row;
  std::uint32_t best = first;
  for (const std::uint32_t row :
       best_rest_rows(score_rest_poses(problem.mesh.poses, members), kRestCandidates)) {
    if (row == first) continue;
    problem.measure.rest_row = row;
    BoxClustering candidate = fit_boxes(problem, clustering.cluster_of_triangle);
    if (!(candidate.cost < clustering.cost)) continue;
    clustering = std::move(candidate);
    best = row;
  }
  problem.measure.rest_row = best;
  return clustering;
}

/// Where growth is on its way, as a share that only rises.
double growth_share(std::uint32_t clusters) { return 0.05 + 0.95 * clusters / (clusters + 40.0); }

/// Clusters as they come from few keys and, of a large mesh, few triangles.
struct RoughClusters {
  std::uint32_t rest_key = 0;
  std::vector<std::uint32_t> cluster_of_triangle;
  std::vector<BoxGrowthStep> steps;
};

/// The row that explains the others best with one cluster.
std::uint32_t first_rest_row(const MovingMesh& mesh) {
  const std::vector<std::uint32_t> whole(mesh.triangles.size(), 0);
  const ClusterMembers members =
      make_cluster_members(mesh.triangles, whole, 1, mesh.poses.vertex_count);
  return best_rest_rows(score_rest_poses(mesh.poses, members), 1)[0];
}

RoughClusters rough_clusters(const MovingMesh& mesh, const DecomposeOptions& options,
                             const std::function<void(const BoxGrowthStep&)>& on_step) {
  const std::size_t triangles = mesh.triangles.size();
  ThinnedMesh thin;
  const bool is_thin = triangles > kWholeTriangles;
  if (is_thin) thin = thinned(mesh.poses, mesh.triangles, triangles / kThinTriangles);
  const MovingMesh few{is_thin ? thin.poses : mesh.poses,
                       is_thin ? std::span<const Triangle>(thin.triangles) : mesh.triangles,
                       mesh.neighbors};
  BoxProblem problem{few, {0, model_box_areas(mesh.poses), {}, 1}};
  problem.measure.rest_row =
      options.rest_key ? row_of_key(mesh.poses, *options.rest_key) : first_rest_row(few);
  problem.measure.triangle_weight =
      static_cast<double>(triangles) / static_cast<double>(few.triangles.size());

  BoxGrowthOptions growth_options;
  growth_options.limit = kRoughClusters;
  if (options.clusters != 0)
    growth_options.limit = std::min(growth_options.limit, options.clusters);
  BoxGrowth growth = grow_boxes(problem, std::vector<std::uint32_t>(few.triangles.size(), 0),
                                growth_options, on_step);
  if (!options.rest_key)
    growth.clustering = with_best_rest_row(problem, std::move(growth.clustering));

  RoughClusters result;
  result.rest_key = mesh.poses.keys[problem.measure.rest_row];
  result.steps = std::move(growth.steps);
  result.cluster_of_triangle = growth.clustering.cluster_of_triangle;
  if (is_thin) {
    problem.measure.triangle_weight = 1;
    result.cluster_of_triangle =
        assign_to_smallest_boxes({mesh, problem.measure}, std::move(growth.clustering.clusters));
    for (std::size_t t = 0; t < thin.sources.size(); ++t)  // so that no cluster is lost
      result.cluster_of_triangle[thin.sources[t]] = growth.clustering.cluster_of_triangle[t];
  }
  return result;
}

}  // namespace

PoseTable sampled_table(const PoseSequence& sequence, std::size_t count,
                        std::optional<std::uint32_t> also, double unit) {
  KeySamplingOptions sampling;
  sampling.count = static_cast<std::uint32_t>(std::min<std::size_t>(count, sequence.key_count()));
  std::vector<std::uint32_t> keys = sample_keys(sequence, sampling);
  if (also && !std::binary_search(keys.begin(), keys.end(), *also))
    keys.insert(std::lower_bound(keys.begin(), keys.end(), *also), *also);
  return make_pose_table(sequence, keys, unit);
}

MotionClusters cluster_by_boxes(const PoseSequence& sequence, const DecomposeOptions& options,
                                double unit, ProgressSink& progress) {
  const VertexTriangles neighbors =
      make_vertex_triangles(sequence.triangles, sequence.vertex_count);
  double furthest = 0.03;  // clusters can become fewer
  const auto on_step = [&](const BoxGrowthStep& s) {
    furthest = std::max(furthest, growth_share(s.clusters));
    progress.report("decompose", furthest);
  };
  const PoseTable few = sampled_table(sequence, kRoughKeys, options.rest_key, unit);
  progress.report("decompose", furthest);
  RoughClusters rough = rough_clusters({few, sequence.triangles, neighbors}, options, on_step);

  const std::size_t affordable = kFineEntries / std::max(1u, sequence.vertex_count);
  const PoseTable many =
      sampled_table(sequence, std::max(affordable, kLeastFineKeys), rough.rest_key, unit);
  const MovingMesh mesh{many, sequence.triangles, neighbors};
  const BoxProblem problem{mesh, {row_of_key(many, rough.rest_key), model_box_areas(many), {}, 1}};
  BoxGrowthOptions growth_options;
  growth_options.clusters = options.clusters;
  growth_options.relax.max_rounds = 2;
  growth_options.polish_rounds = 2;
  const BoxGrowth growth =
      grow_boxes(problem, std::move(rough.cluster_of_triangle), growth_options, on_step);

  MotionClusters result;
  result.rest_key = rough.rest_key;
  result.stop_reason = growth.stop_reason;
  result.cluster_of_triangle = growth.clustering.cluster_of_triangle;
  result.cluster_count = growth.clustering.cluster_count();
  rough.steps.pop_back();  // the fine growth starts with it again
  for (const std::vector<BoxGrowthStep>& steps : {rough.steps, growth.steps})
    for (const BoxGrowthStep& s : steps)
      result.steps.push_back({s.clusters, s.residual_rms, s.cost, s.fuzzy_area});
  return result;
}

MotionClusters cluster_by_residuals(const PoseSequence& sequence, const DecomposeOptions& options,
                                    double unit, ProgressSink& progress) {
  GrowthOptions growth_options;
  growth_options.clusters = options.clusters;
  growth_options.stop_percent = options.stop_percent;
  growth_options.fixed_rest = options.rest_key.has_value();
  const VertexTriangles neighbors =
      make_vertex_triangles(sequence.triangles, sequence.vertex_count);
  const std::size_t vertices = std::max(1u, sequence.vertex_count);
  const PoseTable few =
      sampled_table(sequence, std::clamp<std::size_t>(kResidualGrowthEntries / vertices, 10, 48),
                    options.rest_key, unit);
  progress.report("decompose", 0.05);
  Growth growth = grow_clusters(
      {few, sequence.triangles, neighbors},
      options.rest_key ? row_of_key(few, *options.rest_key) : 0, growth_options,
      [&](const GrowthStep& step) { progress.report("decompose", growth_share(step.clusters)); });

  MotionClusters result;
  result.rest_key = few.keys[growth.clustering.rest_row];
  result.stop_reason = growth.stop_reason;
  for (const GrowthStep& s : growth.steps)
    result.steps.push_back({s.clusters, s.residual_rms, s.cost, s.fuzzy_area});
  const PoseTable many = sampled_table(
      sequence, std::max<std::size_t>(kResidualPolishEntries / vertices, few.row_count()),
      result.rest_key, unit);
  const MovingMesh mesh{many, sequence.triangles, neighbors};
  progress.report("decompose", 0.7);
  Clustering polished = fit_assignment(mesh, row_of_key(many, result.rest_key),
                                       std::move(growth.clustering.cluster_of_triangle));
  Clustering relaxed = relax(mesh, polished, kResidualPolish);
  if (relaxed.cluster_count == polished.cluster_count) polished = std::move(relaxed);
  const ClusterMembers members =
      make_cluster_members(sequence.triangles, polished.cluster_of_triangle, polished.cluster_count,
                           sequence.vertex_count);
  result.local_from_rest =
      choose_local_frames(many, members, polished.maps.maps, growth_options.cost).local_from_rest;
  result.cluster_of_triangle = std::move(polished.cluster_of_triangle);
  result.cluster_count = polished.cluster_count;
  return result;
}

}  // namespace mdk
