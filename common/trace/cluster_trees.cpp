#include "common/trace/cluster_trees.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <iterator>
#include <limits>

#include "common/base/parallel.h"

namespace mdk {
namespace {

constexpr int kBins = 64;  // built once: quality before speed

bool holds(const TriangleBlock& block, std::uint32_t lane, const Triangle& triangle) {
  for (int k = 0; k < 3; ++k)
    if (block.corner[k][lane] != triangle.v[k]) return false;
  return true;
}

/// What is wrong with one block; counts its triangles in `seen`.
std::string validate_block(const TriangleBlock& block, std::span<const Triangle> triangles,
                           std::vector<std::uint8_t>& seen) {
  if (block.count < 1 || block.count > kBlockTriangles) return "has a wrong number of triangles";
  for (std::uint32_t lane = 0; lane < kBlockTriangles; ++lane) {
    const std::uint32_t triangle = block.triangle[lane];
    if (triangle >= triangles.size()) return "names a triangle that is not there";
    if (!holds(block, lane, triangles[triangle])) return "has corners of another triangle";
    if (lane < block.count ? seen[triangle]++ != 0 : triangle != block.triangle[0])
      return lane < block.count ? "holds a triangle a second time" : "has a spare lane of its own";
  }
  return {};
}

}  // namespace

void append_blocks(const WideBvh& bvh, std::span<const Triangle> triangles, std::uint32_t first,
                   std::vector<TriangleBlock>& blocks) {
  for (std::uint32_t leaf = 0; leaf < bvh.leaf_count(); ++leaf) {
    TriangleBlock& block = blocks.emplace_back();
    for (const std::uint32_t item : bvh.leaf(leaf)) {
      if (item == kNoItem) break;
      block.push(first + item, triangles[first + item]);
    }
    block.pad();
  }
}

std::size_t ClusterTrees::bytes() const {
  std::size_t sum = blocks.size() * sizeof(TriangleBlock);
  for (const WideBvh& tree : trees) sum += tree.bytes();
  return sum;
}

ClusterTrees build_cluster_trees(const ModelView& model, std::uint32_t segment) {
  ClusterTrees built;
  built.trees.resize(model.cluster_count());
  parallel_chunks(built.trees.size(), 1, [&](std::size_t c, std::size_t) {
    built.trees[c] = build_wide_bvh(model.cluster_fuzzy_boxes(segment, c), kBins);
  });
  for (std::size_t c = 0; c < built.trees.size(); ++c) {
    built.first_leaf.push_back(static_cast<std::uint32_t>(built.blocks.size()));
    append_blocks(built.trees[c], model.triangles, model.clusters[c].first_triangle, built.blocks);
  }
  assert(validate(built, model).empty());
  return built;
}

LocalBoxes::LocalBoxes(const ModelView& model)
    : triangles_(model.triangles.begin(), model.triangles.end()), boxes_(model.triangle_count()) {
  std::vector<std::uint32_t> corner_of(model.vertex_count), used;
  for (const Cluster& cluster : model.clusters) {
    const auto triangles =
        std::span(triangles_).subspan(cluster.first_triangle, cluster.triangle_count);
    used.clear();
    for (const Triangle& t : triangles) used.insert(used.end(), std::begin(t.v), std::end(t.v));
    std::ranges::sort(used);
    used.erase(std::unique(used.begin(), used.end()), used.end());
    const auto first = static_cast<std::uint32_t>(vertices_.size());
    for (std::uint32_t i = 0; i < used.size(); ++i) corner_of[used[i]] = first + i;
    for (Triangle& t : triangles)
      for (std::uint32_t& v : t.v) v = corner_of[v];
    first_triangle_.push_back(cluster.first_triangle);
    first_corner_.push_back(first);
    vertices_.insert(vertices_.end(), used.begin(), used.end());
  }
  first_triangle_.push_back(model.triangle_count());
  first_corner_.push_back(static_cast<std::uint32_t>(vertices_.size()));
  corner_boxes_.resize(vertices_.size());
}

std::span<const Aabb> LocalBoxes::find(std::size_t c, const Affine3d& local_from_world,
                                       const Vec3f* positions) {
  constexpr double kMax = std::numeric_limits<float>::max();
  constexpr float kInf = std::numeric_limits<float>::infinity();
  constexpr Aabb kEverywhere{{-kInf, -kInf, -kInf}, {kInf, kInf, kInf}};
  for (std::uint32_t i = first_corner_[c]; i < first_corner_[c + 1]; ++i) {
    const Vec3d p = local_from_world.point(to_double(positions[vertices_[i]]));
    const bool is_finite = std::abs(p.x) < kMax && std::abs(p.y) < kMax && std::abs(p.z) < kMax;
    corner_boxes_[i] = is_finite ? round_outward({p, p}) : kEverywhere;
  }
  for (std::uint32_t t = first_triangle_[c]; t < first_triangle_[c + 1]; ++t) {
    Aabb box;
    for (const std::uint32_t corner : triangles_[t].v) box.extend(corner_boxes_[corner]);
    boxes_[t] = box.lo.x == -kInf ? Aabb{{0, 0, 0}, {0, 0, 0}} : box;
  }
  return std::span(boxes_).subspan(first_triangle_[c], first_triangle_[c + 1] - first_triangle_[c]);
}

std::size_t LocalBoxes::bytes() const {
  return (corner_boxes_.size() + boxes_.size()) * sizeof(Aabb) +
         triangles_.size() * sizeof(Triangle) +
         (vertices_.size() + first_corner_.size() + first_triangle_.size()) * sizeof(std::uint32_t);
}

std::string validate(std::span<const TriangleBlock> blocks, std::span<const Triangle> triangles) {
  std::vector<std::uint8_t> seen(triangles.size());
  std::size_t held = 0;
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const std::string wrong = validate_block(blocks[b], triangles, seen);
    if (!wrong.empty()) return "block " + std::to_string(b) + " " + wrong;
    held += blocks[b].count;
  }
  if (held != triangles.size())
    return std::to_string(triangles.size() - held) + " triangles are in no block";
  return {};
}

std::string validate(const ClusterTrees& trees, const ModelView& model) {
  if (trees.trees.size() != model.cluster_count() || trees.first_leaf.size() != trees.trees.size())
    return "clusters and trees differ in number";
  std::size_t next = 0;
  for (std::size_t c = 0; c < trees.trees.size(); ++c) {
    const std::string where = "cluster " + std::to_string(c);
    const WideBvh& tree = trees.trees[c];
    if (trees.first_leaf[c] != next || next + tree.leaf_count() > trees.blocks.size())
      return where + " has leaves without blocks";
    next += tree.leaf_count();
    const std::uint32_t first = model.clusters[c].first_triangle;
    const std::span<const TriangleBlock> blocks = trees.blocks_of(c);
    for (std::uint32_t leaf = 0; leaf < blocks.size(); ++leaf)
      for (std::uint32_t lane = 0; lane < blocks[leaf].count; ++lane)
        if (blocks[leaf].triangle[lane] != first + tree.leaf(leaf)[lane])
          return where + " has a leaf unlike its block";
  }
  if (next != trees.blocks.size()) return "there are blocks without leaves";
  return validate(trees.blocks, model.triangles);
}

}  // namespace mdk
