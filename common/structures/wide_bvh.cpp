#include "common/structures/wide_bvh.h"

#include <array>
#include <cassert>

#include "common/base/parallel.h"

namespace mdk {
namespace {

constexpr std::size_t kNodesPerChunk = 512;

double area(const BvhNode& node) {
  const Vec3d e = to_double(node.hi) - to_double(node.lo);
  return e.x * e.y + e.y * e.z + e.z * e.x;
}

class Collapser {
 public:
  explicit Collapser(const Bvh& binary) : binary_(binary) {}

  WideBvh run() {
    if (binary_.nodes.empty()) return {};
    wide_.nodes.reserve(binary_.nodes.size() / kBvhWidth + 1);
    wide_.items.reserve((binary_.nodes.size() + 1) / 2 * kLeafItems);
    collapse_node(0);
    return std::move(wide_);
  }

 private:
  struct Children {
    std::array<std::uint32_t, kBvhWidth> nodes;  ///< of the binary tree
    std::uint32_t count = 0;
  };

  /// The children of the wide node that stands for binary node `root`.
  Children choose_children(std::uint32_t root) const {
    Children chosen;
    chosen.nodes[chosen.count++] = root;
    while (chosen.count < kBvhWidth) {
      std::uint32_t widest = kBvhWidth;
      double widest_area = -1;
      for (std::uint32_t c = 0; c < chosen.count; ++c) {
        const BvhNode& node = binary_.nodes[chosen.nodes[c]];
        if (node.is_leaf() || area(node) <= widest_area) continue;
        widest = c;
        widest_area = area(node);
      }
      if (widest == kBvhWidth) break;
      const std::uint32_t first = binary_.nodes[chosen.nodes[widest]].first;
      chosen.nodes[widest] = first;
      chosen.nodes[chosen.count++] = first + 1;
    }
    return chosen;
  }

  std::uint32_t collapse_node(std::uint32_t root) {
    const auto index = static_cast<std::uint32_t>(wide_.nodes.size());
    wide_.nodes.emplace_back();
    const Children children = choose_children(root);
    for (std::uint32_t c = 0; c < children.count; ++c) {
      const BvhNode& from = binary_.nodes[children.nodes[c]];
      const WideBvhChild child = from.is_leaf()
                                     ? WideBvhChild::leaf(add_leaf(from))
                                     : WideBvhChild::inner(collapse_node(children.nodes[c]));
      wide_.nodes[index].child[c] = child;
      wide_.nodes[index].set_box(c, from.box());
    }
    wide_.nodes[index].count = children.count;
    wide_.nodes[index].pad();
    return index;
  }

  std::uint32_t add_leaf(const BvhNode& leaf) {
    assert(leaf.count <= kLeafItems);
    const std::uint32_t number = wide_.leaf_count();
    const auto first = binary_.refs.begin() + leaf.first;
    wide_.items.insert(wide_.items.end(), first, first + leaf.count);
    wide_.items.resize((std::size_t{number} + 1) * kLeafItems, kNoItem);
    return number;
  }

  const Bvh& binary_;
  WideBvh wide_;
};

Aabb box_of_items(std::span<const std::uint32_t, kLeafItems> items, std::span<const Aabb> boxes) {
  Aabb box;
  for (const std::uint32_t item : items) {
    if (item == kNoItem) break;
    box.extend(boxes[item]);
  }
  return box;
}

}  // namespace

WideBvh collapse(const Bvh& binary) { return Collapser(binary).run(); }

WideBvh build_wide_bvh(std::span<const Aabb> boxes, int bins) {
  return collapse(
      build_bvh(boxes, {.bins = bins, .intersect_cost = 0.06f, .max_leaf = kLeafItems}));
}

void refit_wide_bvh(WideBvh& bvh, std::span<const Aabb> boxes) {
  // The items are most of the work and do not depend on each other; what is left, a fraction of
  // the nodes, goes bottom up.
  parallel_chunks(bvh.nodes.size(), kNodesPerChunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      WideBvhNode& node = bvh.nodes[i];
      for (std::uint32_t c = 0; c < node.count; ++c)
        if (node.child[c].is_leaf())
          node.set_box(c, box_of_items(bvh.leaf(node.child[c].index()), boxes));
    }
  });
  for (std::size_t i = bvh.nodes.size(); i-- > 0;) {
    WideBvhNode& node = bvh.nodes[i];
    for (std::uint32_t c = 0; c < node.count; ++c)
      if (!node.child[c].is_leaf()) node.set_box(c, bvh.nodes[node.child[c].index()].box());
    node.pad();
  }
}

}  // namespace mdk
