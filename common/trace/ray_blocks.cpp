#include "common/trace/ray_blocks.h"

#include <algorithm>
#include <cmath>

#include "common/base/parallel.h"
#include "common/structures/bvh.h"

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

/// Makes wide nodes of a binary hierarchy: a node's largest inner child gives way to its own two
/// until there are sixteen.
class Widener {
 public:
  Widener(const Bvh& binary, std::uint32_t first, std::span<const Triangle> triangles,
          std::vector<RayBlock>& blocks)
      : binary_(binary), first_(first), triangles_(triangles), blocks_(blocks) {}

  std::vector<RayNode> run() {
    if (!binary_.nodes.empty()) fill(0);
    return std::move(nodes_);
  }

 private:
  std::uint32_t fill(std::uint32_t root) {
    const auto index = static_cast<std::uint32_t>(nodes_.size());
    nodes_.emplace_back();
    std::uint32_t part[kRayWidth] = {root}, count = 1;
    while (count < kRayWidth) {
      const std::uint32_t widest = find_widest(std::span(part).first(count));
      if (widest == count) break;
      const std::uint32_t children = binary_.nodes[part[widest]].first;
      part[widest] = children;
      part[count++] = children + 1;
    }
    for (std::uint32_t c = 0; c < count; ++c) {
      const BvhNode& node = binary_.nodes[part[c]];
      const WideBvhChild child =
          node.is_leaf() ? WideBvhChild::leaf(add_leaf(node)) : WideBvhChild::inner(fill(part[c]));
      nodes_[index].child[c] = child;
      nodes_[index].set_box(c, node.box());
    }
    nodes_[index].count = count;
    nodes_[index].pad();
    return index;
  }

  /// Among the inner ones; as many as there are where none is.
  std::uint32_t find_widest(std::span<const std::uint32_t> parts) const {
    auto widest = static_cast<std::uint32_t>(parts.size());
    double area = -1;
    for (std::uint32_t i = 0; i < parts.size(); ++i) {
      const BvhNode& node = binary_.nodes[parts[i]];
      if (node.is_leaf() || !(half_area(node.box()) > area)) continue;
      area = half_area(node.box());
      widest = i;
    }
    return widest;
  }

  std::uint32_t add_leaf(const BvhNode& leaf) {
    const auto number = static_cast<std::uint32_t>(blocks_.size());
    in_leaf_.clear();
    for (std::uint32_t i = 0; i < leaf.count; ++i)
      in_leaf_.push_back(first_ + binary_.refs[leaf.first + i]);
    append_ray_blocks(in_leaf_, triangles_, blocks_);
    return number;
  }

  const Bvh& binary_;
  const std::uint32_t first_;
  const std::span<const Triangle> triangles_;
  std::vector<RayBlock>& blocks_;
  std::vector<RayNode> nodes_;
  std::vector<std::uint32_t> in_leaf_;
};

std::vector<RayNode> build_ray_tree(std::span<const Aabb> boxes, int bins, std::uint32_t first,
                                    std::span<const Triangle> triangles,
                                    std::vector<RayBlock>& blocks) {
  const Bvh binary =
      build_bvh(boxes, {.bins = bins, .max_leaf = kBlockTriangles, .block = kBlockTriangles});
  std::vector<RayNode> nodes = Widener(binary, first, triangles, blocks).run();
  nodes.shrink_to_fit();
  blocks.shrink_to_fit();
  return nodes;
}

RaySegment::RaySegment(const ModelView& model, std::uint32_t segment)
    : nodes_(model.cluster_count()), blocks_(nodes_.size()), trees_(nodes_.size()) {
  parallel_chunks(nodes_.size(), 1, [&](std::size_t c, std::size_t) {
    nodes_[c] = build_ray_tree(model.cluster_fuzzy_boxes(segment, c), kBins,
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
  for (const auto& nodes : nodes_) sum += nodes.size() * sizeof(RayNode);
  for (const auto& blocks : blocks_) sum += blocks.size() * sizeof(RayBlock);
  return sum;
}

}  // namespace mdk
