#include "preprocess/cluster_growth.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "preprocess/cluster_seeds.h"
#include "preprocess/local_frame.h"
#include "preprocess/rest_pose.h"

namespace mdk {
namespace {

constexpr std::uint32_t kLastRestart = 20;  // with more clusters a restart costs more than it finds
constexpr std::uint32_t kClustersPerBatch = 32;  // one more is added at a time for each so many

ClusterMembers members_of(const MovingMesh& mesh, const Clustering& clustering) {
  return make_cluster_members(mesh.triangles, clustering.cluster_of_triangle,
                              clustering.cluster_count, mesh.poses.vertex_count);
}

/// One or more clusters further, relaxed; unchanged where motion gives no reason for another.
/// Past 32 clusters several are added at a time.
Clustering grown(const MovingMesh& mesh, const Clustering& start, std::uint32_t target) {
  Clustering more = start;
  const std::uint32_t batch = std::max(1u, start.cluster_count / kClustersPerBatch);
  for (std::uint32_t i = 0; i < batch && more.cluster_count < target; ++i) {
    const ClusterOffer offer = best_new_cluster(mesh, more);
    if (!(offer.gain > 0)) break;
    more = accept_offer(mesh, more, offer);
  }
  if (more.cluster_count == start.cluster_count) return start;
  Clustering kept = relax(mesh, more);
  if (more.cluster_count <= kLastRestart) {
    Clustering restarted = relax(mesh, restart_from_prototypes(mesh, more));
    if (restarted.cluster_count == kept.cluster_count && restarted.residual < kept.residual)
      kept = std::move(restarted);
  }
  return kept.cluster_count > start.cluster_count ? kept : start;
}

LocalFrames best_frames(const MovingMesh& mesh, const Clustering& clustering,
                        const CostOptions& options) {
  return choose_local_frames(mesh.poses, members_of(mesh, clustering), clustering.maps.maps,
                             options);
}

GrowthStep describe(const MovingMesh& mesh, const Clustering& clustering,
                    const CostOptions& options) {
  const LocalFrames frames = best_frames(mesh, clustering, options);
  return {clustering.cluster_count, residual_rms(mesh, clustering),
          expected_work(frames.clusters, options), fuzzy_area(frames.clusters)};
}

/// The rule that ends growth, watching step after step; remembers the clustering to return.
class StopRule {
 public:
  explicit StopRule(const GrowthOptions& options) : options_(&options) {}

  /// Looks at a new state; afterwards `reason` tells whether to go on (empty) or why not.
  void look_at(const GrowthStep& step, const Clustering& clustering) {
    const bool first = best_.cluster_count == 0;
    if (options_->clusters != 0) {
      best_ = clustering;
      if (step.clusters >= options_->clusters) reason_ = "count";
    } else if (options_->stop_percent) {
      if (!first && step.residual_rms > last_rms_ * (1 - *options_->stop_percent / 100)) {
        reason_ = "percent";
        return;
      }
      best_ = clustering;
    } else if (first || pays(step)) {
      best_ = clustering;
      best_cost_ = step.cost;
    } else if (step.clusters >= best_.cluster_count + options_->patience) {
      reason_ = "cost";
      return;
    }
    last_rms_ = step.residual_rms;
    if (reason_.empty() && options_->clusters == 0 && step.clusters >= options_->limit)
      reason_ = best_.cluster_count == step.clusters ? "limit" : "cost";
  }

  /// No further cluster can lower the residual.
  void give_up() { reason_ = options_->stop_percent ? "percent" : "cost"; }

  const std::string& reason() const { return reason_; }
  Clustering take_best() { return std::move(best_); }

 private:
  bool pays(const GrowthStep& step) const {
    const double added = step.clusters - best_.cluster_count;
    return step.cost < best_cost_ * (1 - options_->min_gain * added);
  }

  const GrowthOptions* options_;
  Clustering best_;
  double best_cost_ = 0, last_rms_ = 0;
  std::string reason_;
};

}  // namespace

double residual_rms(const MovingMesh& mesh, const Clustering& clustering) {
  const double terms = 3.0 * static_cast<double>(mesh.triangles.size()) * mesh.poses.row_count();
  return std::sqrt(clustering.residual / terms);
}

double clustering_cost(const MovingMesh& mesh, const Clustering& clustering,
                       const CostOptions& options) {
  return expected_work(best_frames(mesh, clustering, options).clusters, options);
}

Clustering with_papers_rest_pose(const MovingMesh& mesh, const Clustering& clustering) {
  RestPoseOptions options;
  options.rule = RestPoseRule::kIsExplained;
  const std::uint32_t row =
      best_rest_rows(score_rest_poses(mesh.poses, members_of(mesh, clustering), options), 1)[0];
  return row == clustering.rest_row ? clustering
                                    : fit_assignment(mesh, row, clustering.cluster_of_triangle);
}

Growth grow_clusters(const MovingMesh& mesh, std::uint32_t rest_row, const GrowthOptions& options,
                     const std::function<void(const GrowthStep&)>& on_step) {
  Growth growth;
  const std::uint32_t target = options.clusters != 0 ? options.clusters : options.limit;
  StopRule rule(options);
  Clustering state =
      fit_assignment(mesh, rest_row, std::vector<std::uint32_t>(mesh.triangles.size(), 0));
  for (;;) {
    if (!options.fixed_rest && std::has_single_bit(state.cluster_count))
      state = with_papers_rest_pose(mesh, state);
    growth.steps.push_back(describe(mesh, state, options.cost));
    on_step(growth.steps.back());
    rule.look_at(growth.steps.back(), state);
    if (!rule.reason().empty()) break;

    Clustering next = grown(mesh, state, target);
    if (next.cluster_count == state.cluster_count && options.clusters == 0) {
      rule.give_up();
      break;
    }
    state = next.cluster_count > state.cluster_count
                ? std::move(next)
                : fit_assignment(mesh, state.rest_row,
                                 halve_largest(mesh, state.rest_row, state.cluster_of_triangle));
  }
  growth.clustering = rule.take_best();
  growth.stop_reason = rule.reason();
  return growth;
}

}  // namespace mdk
