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

RaySegment::RaySegment(const ModelView& model, std::uint32_t segment)
    : nodes_(model.cluster_count()), blocks_(nodes_.size()), trees_(nodes_.size()) {
  parallel_chunks(nodes_.size(), 1, [&](std::size_t c, std::size_t) {
    WideBvh tree = build_wide_bvh(model.cluster_fuzzy_boxes(segment, c), kBins);
    if (tree.nodes.empty()) return;
    std::vector<std::uint32_t> first_block, triangles;
    for (std::uint32_t leaf = 0; leaf < tree.leaf_count(); ++leaf) {
      triangles.clear();
      for (const std::uint32_t item : tree.leaf(leaf)) {
        if (item == kNoItem) break;
        triangles.push_back(model.clusters[c].first_triangle + item);
      }
      first_block.push_back(static_cast<std::uint32_t>(blocks_[c].size()));
      append_ray_blocks(triangles, model.triangles, blocks_[c]);
    }
    for (WideBvhNode& node : tree.nodes)
      for (WideBvhChild& child : node.child)
        if (child.is_leaf()) child = WideBvhChild::leaf(first_block[child.index()]);
    nodes_[c] = std::move(tree.nodes);
    nodes_[c].shrink_to_fit();
    blocks_[c].shrink_to_fit();
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
