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

/// Boxes of the current triangles in their clusters' bases. A corner is mapped once for each
/// cluster that uses it, not once for each triangle.
class LocalBoxes {
 public:
  LocalBoxes() = default;
  /// Cost: O(T log T).
  explicit LocalBoxes(const ModelView& model);

  /// Those of cluster `c`. As triangle_boxes() has it: a point where a corner is not finite, since
  /// such a triangle cannot be hit. The result holds until the next call for this cluster; calls
  /// for different clusters may run at once.
  std::span<const Aabb> find(std::size_t c, const Affine3d& local_from_world,
                             const Vec3f* positions);

  std::size_t bytes() const;

 private:
  std::vector<std::uint32_t> first_triangle_;  ///< K + 1
  std::vector<std::uint32_t> first_corner_;    ///< K + 1: where a cluster's corners begin
  std::vector<std::uint32_t> vertices_;        ///< of the corners, ascending in each cluster
  std::vector<Triangle> triangles_;            ///< T: numbers of corners
  std::vector<Aabb> corner_boxes_, boxes_;
};

/// What is wrong with blocks that should hold each of `triangles` in one lane of one block, with
/// its own corners, spare lanes repeating the first; empty: nothing. Cost: O(T).
std::string validate(std::span<const TriangleBlock> blocks, std::span<const Triangle> triangles);

/// The same for the leaves of all clusters: the blocks of a cluster's tree hold its triangles and
/// no others, leaf by leaf.
std::string validate(const ClusterTrees& trees, const ModelView& model);

}  // namespace mdk
