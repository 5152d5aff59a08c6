// Tree rotations in a wide hierarchy: a child of a node and a grandchild change places. The node's
// own box stays, and so do the boxes of the two; what changes is the box of the child they are, or
// were, under.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "common/structures/wide_bvh.h"

namespace mdk {
namespace {

/// One exchange: child `up` of the node's child `under` for the node's child `down`.
struct Rotation {
  double gain = 0;
  std::uint32_t under = 0, up = 0, down = 0;
};

/// How many levels of nodes hang under each node, and how deep it is: as the tree was before a
/// pass. Going up, no node is deeper when its turn comes than it was then.
struct Levels {
  std::vector<std::uint32_t> depth, height;

  explicit Levels(const WideBvh& bvh) : depth(bvh.nodes.size(), 0), height(bvh.nodes.size(), 0) {
    for (std::size_t i = 0; i < bvh.nodes.size(); ++i) {
      const WideBvhNode& node = bvh.nodes[i];
      for (std::uint32_t c = 0; c < node.count; ++c)
        if (!node.child[c].is_leaf()) depth[node.child[c].index()] = depth[i] + 1;
    }
    for (std::size_t i = bvh.nodes.size(); i-- > 0;) set_height(bvh, i);
  }
  void set_height(const WideBvh& bvh, std::size_t i) {
    const WideBvhNode& node = bvh.nodes[i];
    height[i] = 0;
    for (std::uint32_t c = 0; c < node.count; ++c)
      if (!node.child[c].is_leaf())
        height[i] = std::max(height[i], height[node.child[c].index()] + 1);
  }
  /// Whether a child of node `i` may hang one level deeper.
  bool may_sink(std::size_t i, const WideBvhChild& child) const {
    return child.is_leaf() || depth[i] + 2 + height[child.index()] <= kMaxBvhDepth;
  }
};

/// The boxes of a node's children without each one of them.
std::array<Aabb, kBvhWidth> boxes_without_one(const WideBvhNode& node) {
  std::array<Aabb, kBvhWidth> boxes;
  Aabb before;
  for (std::uint32_t c = 0; c < node.count; ++c) {
    boxes[c] = before;
    before.extend(node.box(c));
  }
  Aabb after;
  for (std::uint32_t c = node.count; c-- > 0;) {
    boxes[c].extend(after);
    after.extend(node.box(c));
  }
  return boxes;
}

/// A node must stand before its children.
bool may_hang_under(const WideBvhChild& child, std::uint32_t node) {
  return child.is_leaf() || child.index() > node;
}

Rotation best_rotation(const WideBvh& bvh, const Levels& levels, std::size_t at) {
  const WideBvhNode& node = bvh.nodes[at];
  Rotation best;
  for (std::uint32_t under = 0; under < node.count; ++under) {
    if (node.child[under].is_leaf()) continue;
    const std::uint32_t index = node.child[under].index();
    const WideBvhNode& other = bvh.nodes[index];
    const std::array<Aabb, kBvhWidth> rest = boxes_without_one(other);
    const double area = half_area(node.box(under));
    for (std::uint32_t down = 0; down < node.count; ++down) {
      const WideBvhChild& child = node.child[down];
      if (down == under || !may_hang_under(child, index) || !levels.may_sink(at, child)) continue;
      for (std::uint32_t up = 0; up < other.count; ++up) {
        Aabb box = rest[up];
        box.extend(node.box(down));
        const double gain = area - half_area(box);
        if (gain > best.gain) best = {gain, under, up, down};
      }
    }
  }
  return best;
}

void rotate(WideBvh& bvh, WideBvhNode& node, const Rotation& rotation) {
  WideBvhNode& other = bvh.nodes[node.child[rotation.under].index()];
  const Aabb goes_down = node.box(rotation.down), goes_up = other.box(rotation.up);
  std::swap(node.child[rotation.down], other.child[rotation.up]);
  node.set_box(rotation.down, goes_up);
  other.set_box(rotation.up, goes_down);
  other.pad();
  node.set_box(rotation.under, other.box());
  node.pad();
}

}  // namespace

std::size_t rotate_wide_bvh(WideBvh& bvh) {
  Levels levels(bvh);
  std::size_t count = 0;
  for (std::size_t i = bvh.nodes.size(); i-- > 0;) {
    for (std::uint32_t turn = 0; turn < kBvhWidth; ++turn) {
      const Rotation rotation = best_rotation(bvh, levels, i);
      if (!(rotation.gain > 0)) break;
      rotate(bvh, bvh.nodes[i], rotation);
      levels.set_height(bvh, bvh.nodes[i].child[rotation.under].index());
      ++count;
    }
    levels.set_height(bvh, i);
  }
  return count;
}

}  // namespace mdk
