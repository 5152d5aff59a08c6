// ClusterTrees: the fuzzy hierarchies of one time segment, one per cluster, and the triangles of
// their leaves: valid at all times of the segment (Lo09 §4.3).
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/motion/model.h"
#include "common/structures/wide_bvh.h"
#include "common/trace/kernels/triangle_block.h"

namespace mdk {

/// The blocks of the leaves of `bvh`, in their order; items are triangle numbers less `first`.
void append_blocks(const WideBvh& bvh, std::span<const Triangle> triangles, std::uint32_t first,
                   std::vector<TriangleBlock>& blocks);

struct ClusterTrees {
  std::vector<WideBvh> trees;             ///< by cluster
  std::vector<std::uint32_t> first_leaf;  ///< by cluster: where its blocks begin
  std::vector<TriangleBlock> blocks;      ///< of all leaves, cluster by cluster

  bool built() const { return !trees.empty(); }
  std::span<const TriangleBlock> blocks_of(std::size_t c) const {
    return std::span(blocks).subspan(first_leaf[c], trees[c].leaf_count());
  }
  std::size_t bytes() const;
};

/// Over the segment's fuzzy boxes. Runs in parallel. Cost: O(T log T). The result depends on the
/// model alone.
ClusterTrees build_cluster_trees(const ModelView& model, std::uint32_t segment);

/// What is wrong with blocks that should hold each of `triangles` in one lane of one block, with
/// its own corners, spare lanes repeating the first; empty: nothing. Cost: O(T).
std::string validate(std::span<const TriangleBlock> blocks, std::span<const Triangle> triangles);

/// The same for the leaves of all clusters: the blocks of a cluster's tree hold its triangles and
/// no others, leaf by leaf.
std::string validate(const ClusterTrees& trees, const ModelView& model);

}  // namespace mdk
