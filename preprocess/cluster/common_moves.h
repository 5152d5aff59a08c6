// What both ways of clustering do, by residuals (paper/) and by boxes (boxes/): Lloyd rounds,
// offers of further clusters, halving where motion gives no reason to split.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "preprocess/decomposition.h"
#include "preprocess/pose/pose_table.h"

namespace mdk {

/// A cluster that does not exist yet.
struct ClusterOffer {
  std::vector<std::uint32_t> triangles;  ///< those it would take over; none: no offer
  double gain = 0;  ///< by how much that lowers residual or cost before any relaxation
};

/// When Lloyd rounds end.
struct RelaxLimits {
  double min_gain = 0.01;  ///< a round that lowers the measure by a smaller share is the last
  int max_rounds = 24;
};

/// Rounds of moving triangles and fitting again. `reassign(clustering)` returns where its triangles
/// go, `fit(assignment)` a clustering; `measure` is what falls. Never above the start's.
template <class Clustering, class Reassign, class Fit>
Clustering relax_rounds(Clustering best, const RelaxLimits& limits, double Clustering::*measure,
                        const Reassign& reassign, const Fit& fit) {
  for (int round = 0; round < limits.max_rounds; ++round) {
    std::vector<std::uint32_t> assignment = reassign(best);
    if (assignment == best.cluster_of_triangle) break;
    Clustering next = fit(std::move(assignment));
    const double gain = best.*measure - next.*measure;
    if (gain <= 0) break;
    const bool last = gain < limits.min_gain * best.*measure;
    best = std::move(next);
    if (last) break;
  }
  return best;
}

/// The cluster with the most triangles cut in two halves at the median of its longest side in the
/// rest pose; at least one cluster must have two triangles. Returns the assignment with one cluster
/// more.
std::vector<std::uint32_t> halve_largest(const MovingMesh& mesh, std::uint32_t rest_row,
                                         const Assignment& assignment);

/// Each number once, rising.
inline std::vector<std::uint32_t> sorted_unique(std::vector<std::uint32_t> numbers) {
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  return numbers;
}

/// How far growth is, as a share that rises with the clusters.
inline double growth_share(std::uint32_t clusters) {
  return 0.05 + 0.95 * clusters / (clusters + 12.0);
}

}  // namespace mdk
