#include "common/trace/cluster_trees.h"

#include "common/base/parallel.h"

namespace mdk {
namespace {

constexpr int kBins = 64;  // built once: quality before speed

}  // namespace

std::size_t ClusterTrees::bytes() const {
  std::size_t sum = blocks.size() * sizeof(TriangleBlock);
  for (const WideBvh& tree : trees) sum += tree.bytes();
  return sum;
}

ClusterTrees build_cluster_trees(const Model& model, std::uint32_t segment) {
  ClusterTrees built;
  built.trees.resize(model.cluster_count());
  parallel_chunks(built.trees.size(), 1, [&](std::size_t c, std::size_t) {
    built.trees[c] = build_wide_bvh(model.cluster_fuzzy_boxes(segment, c), kBins);
  });
  for (std::size_t c = 0; c < built.trees.size(); ++c) {
    built.first_leaf.push_back(static_cast<std::uint32_t>(built.blocks.size()));
    append_blocks(built.trees[c], model.triangles, model.clusters[c].first_triangle, built.blocks);
  }
  return built;
}

}  // namespace mdk
