// Algorithm 1 of GFW06: start with one cluster, relax, add a cluster where motion is worst, and go
// on until more clusters no longer pay.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "preprocess/clustering.h"
#include "preprocess/cost.h"

namespace mdk {

struct GrowthOptions {
  std::uint32_t clusters = 0;          ///< exactly so many; 0: as many as pay
  std::optional<double> stop_percent;  ///< stop when a cluster lowers the RMS residual by less
  std::uint32_t limit = 64;            ///< most clusters without an exact count
  double min_gain = 0.005;             ///< share of the cost that every cluster must save to pay
  std::uint32_t patience = 4;          ///< clusters added that do not pay before giving up
  bool fixed_rest = false;             ///< keep the rest row instead of searching again on the way
  CostOptions cost;
};

/// The state with one more cluster.
struct GrowthStep {
  std::uint32_t clusters = 0;
  double residual_rms = 0;  ///< per corner, table units
  double cost = 0;          ///< expected_work over the table's rows
  double fuzzy_area = 0;    ///< the part of the cost that is fuzzy_area
};

struct Growth {
  Clustering clustering;
  std::vector<GrowthStep> steps;
  std::string stop_reason;  ///< "cost", "percent", "count" or "limit"
};

/// Root of the mean squared residual per triangle corner and row, table units.
double residual_rms(const MovingMesh& mesh, const Clustering& clustering);

/// The cost of a clustering in its best local bases.
double clustering_cost(const MovingMesh& mesh, const Clustering& clustering,
                       const CostOptions& options);

/// The clustering refitted to the rest pose that GFW06 (3) prefers.
Clustering with_papers_rest_pose(const MovingMesh& mesh, const Clustering& clustering);

/// Grows clusters on the rows of `mesh`. After each insertion Lloyd runs twice, from the clusters
/// as they are and from prototypes (GFW06 restarts always; keeping wins about as often), and the
/// lower residual stays. The rest pose is searched again whenever the number of clusters has
/// doubled. `on_step` is called after each step. `options.clusters` must not exceed the number of
/// triangles.
Growth grow_clusters(const MovingMesh& mesh, std::uint32_t rest_row, const GrowthOptions& options,
                     const std::function<void(const GrowthStep&)>& on_step);

}  // namespace mdk
