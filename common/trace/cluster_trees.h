// ClusterTrees: the fuzzy hierarchies of one time segment, one per cluster, and the triangles of
// their leaves: valid at all times of the segment (Lo09 §4.3).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/motion/model.h"
#include "common/structures/wide_bvh.h"
#include "common/trace/kernels/triangle_block.h"

namespace mdk {

struct ClusterTrees {
  std::vector<WideBvh> trees;             ///< by cluster
  std::vector<std::uint32_t> first_leaf;  ///< by cluster: where its blocks begin
  std::vector<TriangleBlock> blocks;      ///< of all leaves, cluster by cluster

  bool built() const { return !trees.empty(); }
  std::size_t bytes() const;
};

/// Over the segment's fuzzy boxes. Runs in parallel. Cost: O(T log T). The result depends on the
/// model alone.
ClusterTrees build_cluster_trees(const Model& model, std::uint32_t segment);

}  // namespace mdk
