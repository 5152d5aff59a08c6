// Moves that Lloyd rounds cannot make (docs/method.md): cutting a cluster in two, and dissolving
// one into the others. Each knows by how much it would lower the cost before any relaxation.
#pragma once

#include <cstdint>
#include <vector>

#include "preprocess/box_clustering.h"

namespace mdk {

/// A cluster cut in two.
struct ClusterSplit {
  std::vector<std::uint32_t> triangles;  ///< those that leave; empty where no cut was found
  double gain = 0;                       ///< by how much the cost falls
};

/// The best cut of every cluster, by a few rounds of two-means from several seeds. Motion decides,
/// not connectivity: a seed's patch is the triangles that stay nearest to it in all poses.
/// Cost: O(rows * vertices), times seeds and rounds; in parallel.
std::vector<ClusterSplit> find_splits(const BoxProblem& problem, const BoxClustering& clustering);

/// `clustering` with the `count` best cuts made (fewer where there are none), fitted, not relaxed.
/// Only cuts that gain more than `least_gain`.
BoxClustering make_splits(const BoxProblem& problem, const BoxClustering& clustering,
                          const std::vector<ClusterSplit>& splits, std::uint32_t count,
                          double least_gain);

/// Dissolves clusters whose triangles would cost less elsewhere, as long as the cost falls.
BoxClustering dissolve_clusters(const BoxProblem& problem, BoxClustering clustering);

}  // namespace mdk
