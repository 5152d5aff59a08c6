#include "preprocess/box_growth.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "preprocess/box_moves.h"
#include "preprocess/cluster_seeds.h"

namespace mdk {
namespace {

constexpr std::uint32_t kFewClusters = 8;  // with more, a stage that saves nothing is the last
constexpr LloydOptions kPolish = {.min_gain = 0.0005, .max_rounds = 4};
constexpr std::uint32_t kPolishShare = 10;  // at most one cluster in so many is cut at a time

BoxGrowthStep describe(const BoxProblem& problem, const BoxClustering& clustering) {
  double residual = 0, area = 0;
  for (const BoxCluster& c : clustering.clusters) {
    residual += c.residual;
    area += c.work.fuzzy_boxes.area(c.work.weights);
  }
  const double terms =
      3.0 * static_cast<double>(problem.mesh.triangles.size()) * problem.mesh.poses.row_count();
  return {clustering.cluster_count(), std::sqrt(residual / terms), clustering.cost, area};
}

/// Exactly `count` clusters, whether motion asks for them or not.
BoxClustering filled_up(const BoxProblem& problem, BoxClustering clustering, std::uint32_t count) {
  while (clustering.cluster_count() < count) {
    const std::uint32_t missing = count - clustering.cluster_count();
    BoxClustering next = make_splits(problem, clustering, find_splits(problem, clustering),
                                     std::min(missing, clustering.cluster_count()),
                                     -std::numeric_limits<double>::infinity());
    if (next.cluster_count() == clustering.cluster_count())
      next = fit_boxes(problem, halve_largest(problem.mesh, problem.measure.rest_row,
                                              std::move(clustering.cluster_of_triangle)));
    clustering = std::move(next);
  }
  return clustering;
}

/// Clusters cut where that gains more than `least_gain`, relaxed.
BoxClustering cut_and_relaxed(const BoxProblem& problem, const BoxClustering& clustering,
                              const BoxGrowthOptions& options, double least_gain) {
  const std::uint32_t most = options.clusters != 0 ? options.clusters : options.limit;
  const std::uint32_t room = most - std::min(most, clustering.cluster_count());
  BoxClustering next = make_splits(problem, clustering, find_splits(problem, clustering),
                                   std::min(room, clustering.cluster_count()), least_gain);
  if (next.cluster_count() == clustering.cluster_count()) return clustering;
  return relax_boxes(problem, std::move(next), options.relax);
}

/// One stage: cut, relax, dissolve what no longer pays. Where no cut pays by itself, several
/// together may: while clusters are few, all clusters are then cut, some times over, before the
/// result is judged.
BoxClustering next_stage(const BoxProblem& problem, const BoxClustering& clustering,
                         const BoxGrowthOptions& options) {
  BoxClustering next = cut_and_relaxed(problem, clustering, options, options.least_cut_gain);
  const int leaps = clustering.cluster_count() <= kFewClusters ? options.leaps : 0;
  for (int leap = 0; leap < leaps && !(next.cost < clustering.cost); ++leap)
    next = cut_and_relaxed(problem, next, options, -std::numeric_limits<double>::infinity());
  const std::uint32_t before = next.cluster_count();
  if (before == clustering.cluster_count()) return clustering;
  next = dissolve_clusters(problem, std::move(next));
  if (next.cluster_count() < before) next = relax_boxes(problem, std::move(next), options.relax);
  return next;
}

/// One careful round: relaxed to rest, rid of what does not pay, and cut in a few places, which
/// stays only where it has paid after all moved.
BoxClustering polished(const BoxProblem& problem, const BoxClustering& clustering,
                       const BoxGrowthOptions& options) {
  BoxClustering next = dissolve_clusters(problem, relax_boxes(problem, clustering, kPolish));
  const std::uint32_t count = next.cluster_count();
  const std::uint32_t room = options.limit - std::min(options.limit, count);
  BoxClustering cut = make_splits(problem, next, find_splits(problem, next),
                                  std::min(room, count / kPolishShare + 1), 0);
  if (cut.cluster_count() == count) return next;
  cut = relax_boxes(problem, std::move(cut), kPolish);
  return cut.cost < next.cost ? cut : next;
}

}  // namespace

BoxGrowth grow_boxes(const BoxProblem& problem, std::vector<std::uint32_t> start,
                     const BoxGrowthOptions& options,
                     const std::function<void(const BoxGrowthStep&)>& on_step) {
  BoxGrowth growth;
  growth.stop_reason = "cost";
  BoxClustering& state = growth.clustering;
  state = fit_boxes(problem, std::move(start));
  const auto record = [&] {
    growth.steps.push_back(describe(problem, state));
    on_step(growth.steps.back());
  };
  record();
  const auto advance = [&](BoxClustering next) {  // whether it pays to go on
    const double gain = state.cost - next.cost;
    if (!(gain > 0)) return false;
    const bool is_last = gain < options.least_stage_gain * state.cost;
    state = std::move(next);
    record();
    return !is_last;
  };
  const bool is_free = options.clusters == 0;
  const std::uint32_t most = is_free ? options.limit : options.clusters;
  while (state.cluster_count() < most && advance(next_stage(problem, state, options))) {
  }
  const int rounds = is_free ? options.polish_rounds : 0;
  for (int round = 0; round < rounds && state.cluster_count() < most; ++round)
    if (!advance(polished(problem, state, options))) break;
  if (!is_free) {
    growth.stop_reason = "count";
    if (state.cluster_count() < most) {
      state = filled_up(problem, std::move(state), most);
      record();
    }
  } else if (state.cluster_count() >= most) {
    growth.stop_reason = "limit";
  }
  return growth;
}

}  // namespace mdk
