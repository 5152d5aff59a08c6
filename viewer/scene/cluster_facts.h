// ClusterFacts: what a file says about each of its clusters.
#pragma once

#include <cstdint>
#include <vector>

#include "common/motion/model.h"

namespace mdk {

struct ClusterFacts {
  std::uint32_t triangles = 0;
  double residual = 0;    ///< RMS over triangles and keys, relative to the rest pose's diagonal
  double cost_share = 0;  ///< of the expected work of a ray that meets the model; all sum to 1
};

/// One per cluster. The cost of a cluster is how often a ray that meets the model's bounds meets
/// the cluster's (by their surface areas in the world, mean over keys), times the cost of entering
/// it and of its fuzzy kd-trees (SAH, mean over keys): docs/method.md, cost. Residuals are taken at
/// keys spread evenly over the file, fewer of them where it has many vertices. Cost: O(keys *
/// clusters + tree nodes), and at most some ten million vertices.
std::vector<ClusterFacts> cluster_facts(const Model& model);

}  // namespace mdk
