// How many clusters: from one, all clusters that pay are cut at once, relaxed, and those that no
// longer pay are dissolved, until the cost stays.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "preprocess/cluster/boxes/box_clusters.h"
#include "preprocess/cluster/clusters.h"
#include "preprocess/pose/pose_table.h"
#include "preprocess/pose/rest_pose.h"

namespace mdk {
namespace {

// Clusters are grown on few keys, and on few triangles of a large mesh, as long as they are few;
// then on all triangles and as many keys as a budget of entries (keys times vertices) allows.
constexpr std::uint32_t kRoughKeys = 32, kRoughClusters = 32;
constexpr std::size_t kWholeTriangles = 24'000;  // larger meshes are thinned to...
constexpr std::size_t kThinTriangles = 6'000;    // ...so many, which rarely share vertices
constexpr std::size_t kFineEntries = 400'000, kMinFineKeys = 16;
constexpr std::size_t kRestCandidates = 2;
constexpr double kRestSearch = 2e8;  // multiply-adds
constexpr double kRoughShare = 0.4;  // of the work that growth is

constexpr std::uint32_t kMaxGrown = 80;    // clusters, where none are requested
constexpr double kMinCutGain = -0.1;       // a cut may cost a little: relaxation pays it back
constexpr int kLeaps = 3;                  // stages that may raise the cost before growth gives up
constexpr std::uint32_t kFewClusters = 8;  // with more, a stage that saves nothing is the last
constexpr RelaxLimits kPolish = {.min_gain = 0.0005, .max_rounds = 4};
constexpr std::uint32_t kPolishShare = 10;  // at most one cluster in so many is cut at a time
constexpr int kExchangeRounds = 6;
constexpr std::uint32_t kExchangeShare =
    8;  // at most one cluster in so many is exchanged at a time

/// How far clusters grow, and with how much care.
struct BoxGrowthPlan {
  std::uint32_t clusters = 0;       ///< exactly so many; 0: as many as pay
  std::uint32_t limit = kMaxGrown;  ///< without an exact count
  RelaxLimits relax{.min_gain = 0.005, .max_rounds = 3};
  int polish_rounds = 0;    ///< of careful cuts at the end, where growth ended because of the cost
  int exchange_rounds = 0;  ///< after all others
  bool keeps_parts_whole = false;  ///< those that move rigidly
  double min_stage_gain = 0.01;    ///< share of the cost that a stage must save to go on

  std::uint32_t target() const { return clusters != 0 ? clusters : limit; }
  /// What one more cluster costs that decides nothing: all of it where their number is given.
  double settled_cost() const { return clusters != 0 ? kClusterCost : 0; }
};

GrowthStep describe(const BoxProblem& problem, const BoxClustering& clustering) {
  double residual = 0, area = 0;
  for (const BoxCluster& c : clustering.clusters) {
    residual += c.residual;
    area += c.work.area();
  }
  const double terms =
      3.0 * static_cast<double>(problem.mesh.triangles.size()) * problem.mesh.poses.row_count();
  return {clustering.cluster_count, std::sqrt(residual / terms), clustering.cost, area};
}

/// Exactly `count` clusters, whether motion asks for them or not.
BoxClustering filled_up(const BoxProblem& problem, BoxClustering clustering, std::uint32_t count) {
  while (clustering.cluster_count < count) {
    const std::uint32_t missing = count - clustering.cluster_count;
    BoxClustering next = make_splits(problem, clustering, find_splits(problem, clustering),
                                     std::min(missing, clustering.cluster_count),
                                     -std::numeric_limits<double>::infinity());
    if (next.cluster_count == clustering.cluster_count)
      next = fit_boxes(problem, halve_largest(problem.mesh, problem.measure.rest_row, clustering));
    clustering = std::move(next);
  }
  return clustering;
}

/// Clusters cut where that gains more than `min_gain`, relaxed.
BoxClustering cut_and_relaxed(const BoxProblem& problem, const BoxClustering& clustering,
                              const BoxGrowthPlan& plan, double min_gain) {
  const std::uint32_t room = plan.target() - std::min(plan.target(), clustering.cluster_count);
  BoxClustering next =
      make_splits(problem, clustering, find_splits(problem, clustering),
                  std::min(room, clustering.cluster_count), min_gain - plan.settled_cost());
  if (next.cluster_count == clustering.cluster_count) return clustering;
  return relax_boxes(problem, std::move(next), plan.relax);
}

/// One stage: cut, relax, dissolve what no longer pays. Where no cut pays by itself, several
/// together may: while clusters are few, all clusters are then cut, some times over, before the
/// result is judged.
BoxClustering next_stage(const BoxProblem& problem, const BoxClustering& clustering,
                         const BoxGrowthPlan& plan) {
  BoxClustering next = cut_and_relaxed(problem, clustering, plan, kMinCutGain);
  const int leaps = clustering.cluster_count <= kFewClusters ? kLeaps : 0;
  for (int leap = 0; leap < leaps && !(next.cost < clustering.cost); ++leap)
    next = cut_and_relaxed(problem, next, plan, -std::numeric_limits<double>::infinity());
  const std::uint32_t before = next.cluster_count;
  if (before == clustering.cluster_count) return clustering;
  next = dissolve_clusters(problem, std::move(next));
  if (next.cluster_count < before) next = relax_boxes(problem, std::move(next), plan.relax);
  return next;
}

/// One careful round: relaxed to rest, rid of what does not pay, and cut in a few places, which
/// stays only where it has paid after all moved.
BoxClustering polished(const BoxProblem& problem, const BoxClustering& clustering,
                       const BoxGrowthPlan& plan) {
  BoxClustering next = dissolve_clusters(problem, relax_boxes(problem, clustering, kPolish));
  const std::uint32_t count = next.cluster_count;
  const std::uint32_t room = plan.limit - std::min(plan.limit, count);
  BoxClustering cut = make_splits(problem, next, find_splits(problem, next),
                                  std::min(room, count / kPolishShare + 1), 0);
  if (cut.cluster_count == count) return next;
  cut = relax_boxes(problem, std::move(cut), kPolish);
  return cut.cost < next.cost ? cut : next;
}

/// One round of exchanges, at first of many clusters, then of fewer; kept where all has paid.
BoxClustering exchanged(const BoxProblem& problem, const BoxClustering& clustering,
                        const BoxGrowthPlan& plan, int round) {
  const std::uint32_t share = round < 2 ? kExchangeShare : 2 * kExchangeShare;
  BoxClustering next =
      exchange_clusters(problem, clustering, std::max(1u, clustering.cluster_count / share));
  next = relax_boxes(problem, std::move(next), plan.relax);
  const bool is_better =
      next.cost < clustering.cost && next.cluster_count == clustering.cluster_count;
  return is_better ? next : clustering;
}

/// `on_step` is called with the start and after each stage.
Growth grow_boxes(const BoxProblem& problem, BoxClustering state, const BoxGrowthPlan& plan,
                  const OnGrowthStep& on_step) {
  Growth growth;
  growth.stop_reason = StopReason::kCost;
  growth.rest_key = problem.mesh.poses.keys[problem.measure.rest_row];
  const auto record = [&] {
    growth.steps.push_back(describe(problem, state));
    on_step(growth.steps.back());
  };
  record();
  const auto advance = [&](BoxClustering next) {  // whether it pays to go on
    const double more = static_cast<double>(next.cluster_count) - state.cluster_count;
    const double gain = state.cost - next.cost + more * plan.settled_cost();
    if (!(gain > 0)) return false;
    const bool is_last = gain < plan.min_stage_gain * state.cost;
    state = std::move(next);
    record();
    return !is_last;
  };
  const bool is_free = plan.clusters == 0;
  while (state.cluster_count < plan.target() && advance(next_stage(problem, state, plan))) {
  }
  const int rounds = is_free ? plan.polish_rounds : 0;
  for (int round = 0; round < rounds && state.cluster_count < plan.target(); ++round)
    if (!advance(polished(problem, state, plan))) break;
  if (!is_free) {
    growth.stop_reason = StopReason::kCount;
    if (state.cluster_count < plan.target()) {
      state = filled_up(problem, std::move(state), plan.target());
      record();
    }
  } else if (state.cluster_count >= plan.target()) {
    growth.stop_reason = StopReason::kLimit;
  }
  for (int round = 0; round < plan.exchange_rounds && state.cluster_count > 1; ++round)
    if (!advance(exchanged(problem, state, plan, round))) break;
  if (plan.keeps_parts_whole) {
    state = with_whole_parts(problem, std::move(state), find_rigid_parts(problem.mesh));
    growth.steps.back() = describe(problem, state);
  }
  static_cast<Assignment&>(growth) = std::move(state);
  return growth;
}

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
  static_cast<PointArrays&>(mesh.poses) = gather_vertices(table, vertices);
  return mesh;
}

/// The assignment fitted to the best of some rest keys by cost.
BoxClustering with_best_rest_key(BoxProblem& problem, const std::vector<std::uint32_t>& assignment,
                                 std::span<const std::uint32_t> keys) {
  BoxClustering best;
  std::uint32_t best_row = 0;
  for (const std::uint32_t key : keys) {
    problem.measure.rest_row = row_of_key(problem.mesh.poses, key);
    BoxClustering candidate = fit_boxes(problem, assignment);
    if (best.cluster_count > 0 && !(candidate.cost < best.cost)) continue;
    best = std::move(candidate);
    best_row = problem.measure.rest_row;
  }
  problem.measure.rest_row = best_row;
  return best;
}

/// The row that explains the others best with one cluster.
std::uint32_t first_rest_row(const MovingMesh& mesh) {
  const ClusterMembers whole = mesh.members_of(one_cluster(mesh.triangles.size()));
  return best_rest_rows(score_rest_poses(mesh.poses, whole), 1)[0];
}

/// Clusters as they come from few keys and, of a large mesh, few triangles.
Growth grow_roughly(const MovingMesh& mesh, const ClusterRequest& request,
                    const OnGrowthStep& on_step) {
  const std::size_t triangles = mesh.triangles.size();
  ThinnedMesh thin;
  const bool is_thin = triangles > kWholeTriangles;
  if (is_thin) thin = thinned(mesh.poses, mesh.triangles, triangles / kThinTriangles);
  const MovingMesh few = is_thin ? MovingMesh{thin.poses, thin.triangles} : mesh;
  BoxProblem problem{few, {0, row_box_areas(mesh.poses), 1}};
  problem.measure.rest_row =
      request.rest_key ? row_of_key(mesh.poses, *request.rest_key) : first_rest_row(few);
  problem.measure.triangle_weight =
      static_cast<double>(triangles) / static_cast<double>(few.triangles.size());

  BoxGrowthPlan plan;
  plan.limit = request.clusters != 0 ? std::min(kRoughClusters, request.clusters) : kRoughClusters;
  Growth growth =
      grow_boxes(problem, fit_boxes(problem, one_cluster(few.triangles.size()).cluster_of_triangle),
                 plan, on_step);
  if (!is_thin) return growth;

  BoxClustering fitted = fit_boxes(problem, growth.cluster_of_triangle);
  problem.measure.triangle_weight = 1;
  std::vector<std::uint32_t> assignment =
      assign_to_smallest_boxes({mesh, problem.measure}, std::move(fitted.clusters));
  for (std::size_t t = 0; t < thin.sources.size(); ++t)  // so that no cluster is lost
    assignment[thin.sources[t]] = growth.cluster_of_triangle[t];
  growth.cluster_of_triangle = std::move(assignment);
  return growth;
}

/// The rest poses that explain all others best with these clusters, out of all keys, and the one
/// that they were grown with.
std::vector<std::uint32_t> rest_candidates(const PoseSequence& sequence,
                                           const ClusterRequest& request, const Growth& growth,
                                           double unit) {
  if (request.rest_key) return {*request.rest_key};
  const ClusterMembers members =
      make_cluster_members(sequence.triangles, growth, sequence.vertex_count);
  std::vector<std::uint32_t> keys = best_rest_keys(
      sequence, members, unit, {.count = kRestCandidates, .max_multiply_adds = kRestSearch});
  keys.push_back(growth.rest_key);
  return sorted_unique(std::move(keys));
}

/// The clusters of the rig's bones, where there is one and they are not too many: whoever made it
/// knew what moves alike.
std::optional<std::vector<std::uint32_t>> bone_start(const BoxProblem& problem,
                                                     const PoseSequence& sequence,
                                                     const BoxGrowthPlan& plan) {
  if (!sequence.rig) return std::nullopt;
  BoneClusters bones = assign_to_bones(sequence, problem.mesh.poses, nullptr);
  if (bones.cluster_count > plan.target()) return std::nullopt;
  return std::move(bones.cluster_of_triangle);
}

}  // namespace

Growth cluster_by_boxes(const PoseSequence& sequence, const ClusterRequest& request, double unit,
                        ProgressSink& progress) {
  double farthest = 0.03;  // clusters can become fewer
  const auto on_step = [&](const GrowthStep& s) {
    farthest = std::max(farthest, growth_share(s.clusters));
    progress.report("decompose", farthest);
  };
  const PoseTable few = sample_poses(sequence, kRoughKeys, requested_rest_keys(request), unit);
  progress.report("decompose", farthest);
  Growth rough = grow_roughly({few, sequence.triangles}, request, on_step);
  farthest = std::max(farthest, kRoughShare);
  progress.report("decompose", farthest);

  const std::vector<std::uint32_t> rest_keys = rest_candidates(sequence, request, rough, unit);
  const std::size_t affordable = kFineEntries / std::max(1u, sequence.vertex_count);
  const PoseTable many =
      sample_poses(sequence, std::max(affordable, kMinFineKeys), rest_keys, unit);
  BoxProblem problem{{many, sequence.triangles}, {0, row_box_areas(many), 1}};
  BoxGrowthPlan plan;
  plan.clusters = request.clusters;
  plan.relax.max_rounds = 2;
  plan.polish_rounds = 1;
  plan.exchange_rounds = kExchangeRounds;
  plan.keeps_parts_whole = request.clusters == 0;
  if (request.clusters != 0) plan.min_stage_gain = 0.0005;  // it is all that can be chosen
  BoxClustering start = with_best_rest_key(problem, rough.cluster_of_triangle, rest_keys);
  if (const auto bones = bone_start(problem, sequence, plan))
    if (BoxClustering fitted = fit_boxes(problem, *bones); fitted.cost < start.cost)
      start = std::move(fitted);
  Growth fine = grow_boxes(problem, std::move(start), plan, on_step);
  rough.steps.pop_back();  // the fine growth starts with it again
  fine.steps.insert(fine.steps.begin(), rough.steps.begin(), rough.steps.end());
  return fine;
}

}  // namespace mdk
