// Algorithm 1 of GFW06: start with one cluster, relax, add a cluster where motion is worst, and go
// on until another one gains too little.
#include <algorithm>
#include <bit>
#include <cstddef>
#include <utility>

#include "preprocess/boxes/cost.h"
#include "preprocess/cluster/clusters.h"
#include "preprocess/cluster/paper/residual_clusters.h"
#include "preprocess/maps/cluster_maps.h"
#include "preprocess/pose/rest_pose.h"

namespace mdk {
namespace {

constexpr std::uint32_t kLastRestart = 20;  // with more clusters a restart costs more than it finds
constexpr std::uint32_t kClustersPerBatch = 32;  // one more is added at a time for each so many

constexpr std::size_t kGrowthEntries = 250'000;  // keys times vertices
constexpr std::size_t kMinGrowthKeys = 10, kMaxGrowthKeys = 48;
constexpr std::size_t kPolishEntries = 8'000'000;
constexpr RelaxLimits kPolish = {.min_gain = 0.002, .max_rounds = 8};
constexpr int kRestSearches = 3;  // at the end: clusters follow the rest pose, and it follows them

/// One or more clusters further, relaxed; unchanged where motion gives no reason for another.
/// Past 32 clusters several are added at a time.
ResidualClustering grown(const ConnectedMesh& mesh, const ResidualClustering& start,
                         std::uint32_t target) {
  ResidualClustering more = start;
  const std::uint32_t batch = std::max(1u, start.cluster_count / kClustersPerBatch);
  for (std::uint32_t i = 0; i < batch && more.cluster_count < target; ++i) {
    const ClusterOffer offer = best_new_cluster(mesh, more);
    if (!(offer.gain > 0)) break;
    more = accept_offer(mesh, more, offer);
  }
  if (more.cluster_count == start.cluster_count) return start;
  ResidualClustering kept = relax(mesh, more);
  if (more.cluster_count <= kLastRestart) {
    ResidualClustering restarted = relax(mesh, restart_from_prototypes(mesh, more));
    if (restarted.cluster_count == kept.cluster_count && restarted.residual < kept.residual)
      kept = std::move(restarted);
  }
  return kept.cluster_count > start.cluster_count ? kept : start;
}

GrowthStep describe(const MovingMesh& mesh, const ResidualClustering& clustering) {
  const std::vector<ClusterWork> clusters =
      choose_local_frames(mesh.poses, mesh.members_of(clustering), clustering.maps).clusters;
  return {clustering.cluster_count, clustering.rms(mesh), expected_work(clusters),
          fuzzy_area(clusters)};
}

/// x to a whole power, the same on every machine.
double power(double x, std::uint32_t exponent) {
  double result = 1;
  for (; exponent > 0; --exponent) result *= x;
  return result;
}

/// The clustering refitted to the rest pose that GFW06 (3) prefers.
ResidualClustering with_papers_rest_pose(const MovingMesh& mesh, ResidualClustering clustering) {
  const std::uint32_t row = best_rest_rows(
      score_rest_poses(mesh.poses, mesh.members_of(clustering), RestPoseRule::kIsExplained), 1)[0];
  if (row == clustering.rest_row) return clustering;
  return fit_residuals(mesh, row, std::move(clustering.cluster_of_triangle));
}

}  // namespace

Growth grow_by_residuals(const MovingMesh& moving, const ClusterRequest& request,
                         const OnGrowthStep& on_step) {
  const ConnectedMesh mesh(moving);
  const bool is_counted = request.clusters != 0;
  const std::uint32_t target =
      is_counted
          ? request.clusters
          : static_cast<std::uint32_t>(std::min<std::size_t>(kMaxClusters, mesh.triangles.size()));
  const double kept_share = 1 - request.stop_percent.value_or(0) / 100;
  Growth growth;
  ResidualClustering state =
      fit_residuals(mesh, request.rest_key ? row_of_key(mesh.poses, *request.rest_key) : 0,
                    one_cluster(mesh.triangles.size()).cluster_of_triangle);
  for (;;) {
    if (!request.rest_key && std::has_single_bit(state.cluster_count))
      state = with_papers_rest_pose(mesh, std::move(state));
    const GrowthStep step = describe(mesh, state);
    const bool gains_little =  // for each of the clusters that were added
        !is_counted && !growth.steps.empty() &&
        step.residual_rms > growth.steps.back().residual_rms *
                                power(kept_share, step.clusters - growth.steps.back().clusters);
    growth.steps.push_back(step);
    on_step(step);
    if (gains_little) {  // without this last cluster
      growth.stop_reason = StopReason::kPercent;
      return growth;
    }
    static_cast<Assignment&>(growth) = state;
    growth.rest_key = mesh.poses.keys[state.rest_row];
    if (state.cluster_count >= target) {
      growth.stop_reason = is_counted ? StopReason::kCount : StopReason::kLimit;
      return growth;
    }
    ResidualClustering next = grown(mesh, state, target);
    if (next.cluster_count == state.cluster_count && !is_counted) {
      growth.stop_reason = StopReason::kPercent;
      return growth;
    }
    state = next.cluster_count > state.cluster_count
                ? std::move(next)
                : fit_residuals(mesh, state.rest_row, halve_largest(mesh, state.rest_row, state));
  }
}

PaperClusters cluster_by_residuals(const PoseSequence& sequence, const ClusterRequest& request,
                                   double unit, ProgressSink& progress) {
  const std::size_t vertices = std::max(1u, sequence.vertex_count);
  const std::size_t keys = std::clamp(kGrowthEntries / vertices, kMinGrowthKeys, kMaxGrowthKeys);
  const PoseTable few = sample_poses(sequence, keys, requested_rest_keys(request), unit);
  progress.report("decompose", 0.05);
  const auto on_step = [&](const GrowthStep& step) {
    progress.report("decompose", growth_share(step.clusters));
  };
  PaperClusters result{grow_by_residuals({few, sequence.triangles}, request, on_step), {}};

  progress.report("decompose", 0.7);
  const std::size_t many = std::max<std::size_t>(kPolishEntries / vertices, few.row_count());
  for (int search = 0; search < kRestSearches; ++search) {
    const PoseTable table = sample_poses(sequence, many, {&result.rest_key, 1}, unit);
    const MovingMesh mesh{table, sequence.triangles};
    ResidualClustering polished = fit_residuals(mesh, row_of_key(table, result.rest_key),
                                                std::move(result.cluster_of_triangle));
    ResidualClustering relaxed = relax(mesh, polished, kPolish);
    if (relaxed.cluster_count == polished.cluster_count) polished = std::move(relaxed);
    const ClusterMembers members = mesh.members_of(polished);
    result.local_from_rest = choose_local_frames(table, members, polished.maps).local_from_rest;
    static_cast<Assignment&>(result) = std::move(polished);
    if (request.rest_key) break;
    const std::uint32_t best =
        best_rest_keys(sequence, members, unit, {RestPoseRule::kIsExplained, 1})[0];
    if (best == result.rest_key || search + 1 == kRestSearches) break;
    result.rest_key = best;
  }
  return result;
}

}  // namespace mdk
