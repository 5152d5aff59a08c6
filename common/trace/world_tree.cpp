#include "common/trace/world_tree.h"

#include <cmath>

#include "common/base/parallel.h"
#include "common/math/aabb.h"
#include "common/trace/ray_blocks.h"

namespace mdk {
namespace {

constexpr int kBins = 16;
constexpr std::size_t kTrianglesPerChunk = 4096;

bool is_finite(const Vec3f& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

}  // namespace

WorldTree::WorldTree(const ModelView& model, const std::vector<std::uint32_t>& place_of_vertex,
                     const VertexSource& source) {
  std::vector<Triangle> triangles(model.triangles.begin(), model.triangles.end());
  for (Triangle& t : triangles)
    for (std::uint32_t& v : t.v) v = place_of_vertex[v];
  std::vector<Aabb> boxes(triangles.size());
  parallel_chunks(boxes.size(), kTrianglesPerChunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      const auto corner = [&](int k) { return source.position(triangles[t].v[k]); };
      const Vec3f a = corner(0), b = corner(1), c = corner(2);
      const bool finite = is_finite(a) && is_finite(b) && is_finite(c);
      for (const Vec3f& v : {a, b, c}) boxes[t].extend(finite ? v : Vec3f{});
    }
  });
  nodes_ = build_ray_tree(boxes, kBins, 0, triangles, blocks_);
}

PosedWorldTree::PosedWorldTree(const WorldTree& tree, const VertexSource& source)
    : nodes_(tree.nodes()), posed_(tree.blocks().size()) {
  const std::vector<RayBlock>& blocks = tree.blocks();
  std::vector<Aabb> boxes(blocks.size());
  pose_blocks(blocks, source, posed_.data(), boxes.data());
  for (std::size_t i = nodes_.size(); i-- > 0;) {
    RayNode& node = nodes_[i];
    for (std::uint32_t c = 0; c < node.count; ++c) {
      const std::uint32_t below = node.child[c].index();
      if (!node.child[c].is_leaf()) {
        node.set_box(c, nodes_[below].box());
        continue;
      }
      Aabb box = boxes[below];
      for (std::uint32_t b = below; blocks[b].has_next; ++b) box.extend(boxes[b + 1]);
      node.set_box(c, box);
    }
    node.pad();
  }
  const Aabb bounds = nodes_.empty() ? Aabb{{0, 0, 0}, {0, 0, 0}} : nodes_[0].box();
  scene_ = {.center = bounds.center(),
            .diagonal = diagonal(bounds),
            .bounds = {{bounds.lo.x, bounds.lo.y, bounds.lo.z, 0},
                       {bounds.hi.x, bounds.hi.y, bounds.hi.z, 0}},
            .nodes = nodes_,
            .blocks = blocks.data(),
            .posed = posed_.data()};
}

}  // namespace mdk
