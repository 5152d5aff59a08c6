#include "common/trace/ray_blocks.h"

#include <algorithm>
#include <cmath>

#include "common/base/parallel.h"

namespace mdk {
namespace {

constexpr int kBins = 64;  // built once: quality before speed

/// Fills a block triangle by triangle.
class BlockFiller {
 public:
  explicit BlockFiller(RayBlock& block) : block_(block) { block_ = {}; }

  /// False where it has no room.
  bool push(std::uint32_t number, const Triangle& t) {
    if (block_.count == kBlockTriangles) return false;
    std::uint32_t places[3], used = vertices_;
    for (int k = 0; k < 3; ++k) {
      std::uint32_t place = 0;
      while (place < used && block_.vertex[place] != t.v[k]) ++place;
      if (place == kBlockVertices) return false;
      if (place == used) block_.vertex[used++] = t.v[k];
      places[k] = place;
    }
    vertices_ = used;
    for (int k = 0; k < 3; ++k)
      block_.corner[k][block_.count] = static_cast<std::uint8_t>(places[k]);
    block_.triangle[block_.count++] = number;
    return true;
  }
  void finish() {
    for (std::uint32_t v = vertices_; v < kBlockVertices; ++v) block_.vertex[v] = block_.vertex[0];
    for (std::uint32_t i = block_.count; i < kBlockTriangles; ++i) {
      for (auto& row : block_.corner) row[i] = row[0];
      block_.triangle[i] = block_.triangle[0];
    }
  }

 private:
  RayBlock& block_;
  std::uint32_t vertices_ = 0;
};

}  // namespace

void append_ray_blocks(std::span<const std::uint32_t> triangles, std::span<const Triangle> all,
                       std::vector<RayBlock>& blocks) {
  std::size_t next = 0;
  while (next < triangles.size()) {
    RayBlock& block = blocks.emplace_back();
    BlockFiller filler(block);
    while (next < triangles.size() && filler.push(triangles[next], all[triangles[next]])) ++next;
    filler.finish();
    block.has_next = next < triangles.size();
  }
}

std::vector<WideBvhNode> take_nodes(WideBvh tree, std::uint32_t first,
                                    std::span<const Triangle> triangles,
                                    std::vector<RayBlock>& blocks) {
  std::vector<std::uint32_t> first_block, in_leaf;
  for (std::uint32_t leaf = 0; leaf < tree.leaf_count(); ++leaf) {
    in_leaf.clear();
    for (const std::uint32_t item : tree.leaf(leaf)) {
      if (item == kNoItem) break;
      in_leaf.push_back(first + item);
    }
    first_block.push_back(static_cast<std::uint32_t>(blocks.size()));
    append_ray_blocks(in_leaf, triangles, blocks);
  }
  for (WideBvhNode& node : tree.nodes)
    for (WideBvhChild& child : node.child)
      if (child.is_leaf()) child = WideBvhChild::leaf(first_block[child.index()]);
  tree.nodes.shrink_to_fit();
  blocks.shrink_to_fit();
  return std::move(tree.nodes);
}

RaySegment::RaySegment(const ModelView& model, std::uint32_t segment)
    : nodes_(model.cluster_count()), blocks_(nodes_.size()), trees_(nodes_.size()) {
  parallel_chunks(nodes_.size(), 1, [&](std::size_t c, std::size_t) {
    nodes_[c] = take_nodes(build_wide_bvh(model.cluster_fuzzy_boxes(segment, c), kBins),
                           model.clusters[c].first_triangle, model.triangles, blocks_[c]);
    if (nodes_[c].empty()) return;
    trees_[c] = {nodes_[c], blocks_[c].data(), {}};
    const Aabb box = nodes_[c][0].box();
    for (std::size_t k = 0; k < 3; ++k)
      trees_[c].size[k] = std::max(std::abs(box.lo[k]), std::abs(box.hi[k]));
  });
}

std::size_t RaySegment::bytes() const {
  std::size_t sum = trees_.size() * (sizeof(RayTree) + sizeof nodes_[0] + sizeof blocks_[0]);
  for (const auto& nodes : nodes_) sum += nodes.size() * sizeof(WideBvhNode);
  for (const auto& blocks : blocks_) sum += blocks.size() * sizeof(RayBlock);
  return sum;
}

}  // namespace mdk
