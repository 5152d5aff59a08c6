// Hierarchies whose nodes hold the boxes of up to eight children side by side, so that a tile tests
// them all at once. WideBvh: leaves hold up to sixteen items, as many as are tested together; made
// by collapsing a binary Bvh; follows moving items by refitting and rotations. TopLevel: one box a
// leaf, made anew for every frame.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/math/aabb.h"
#include "common/structures/bvh.h"

namespace mdk {

inline constexpr std::uint32_t kBvhWidth = 8;
inline constexpr std::uint32_t kLeafItems = 16;
inline constexpr std::uint32_t kNoItem = 0xffffffffu;

/// A link to a leaf or to an inner node.
class WideBvhChild {
 public:
  WideBvhChild() = default;
  static WideBvhChild leaf(std::uint32_t number) { return WideBvhChild(number | kLeafBit); }
  static WideBvhChild inner(std::uint32_t node) { return WideBvhChild(node); }

  bool is_leaf() const { return (word_ & kLeafBit) != 0; }
  /// Of the leaf or of the inner node.
  std::uint32_t index() const { return word_ & ~kLeafBit; }

 private:
  static constexpr std::uint32_t kLeafBit = 0x80000000u;
  explicit WideBvhChild(std::uint32_t word) : word_(word) {}
  std::uint32_t word_;
};

/// Rows of `bounds`: low x, high x, low y, high y, low z, high z; one column per child. Columns
/// from `count` on repeat column 0, so that they hold numbers.
template <std::uint32_t kWidth>
struct alignas(64) WideNode {
  float bounds[6][kWidth];
  WideBvhChild child[kWidth];
  std::uint32_t count;

  Aabb box(std::uint32_t c) const {
    return {{bounds[0][c], bounds[2][c], bounds[4][c]}, {bounds[1][c], bounds[3][c], bounds[5][c]}};
  }
  void set_box(std::uint32_t c, const Aabb& box) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      bounds[2 * axis][c] = box.lo[axis];
      bounds[2 * axis + 1][c] = box.hi[axis];
    }
  }
  /// The union of the children's boxes.
  Aabb box() const {
    Aabb all;
    for (std::uint32_t c = 0; c < count; ++c) all.extend(box(c));
    return all;
  }
  /// Fills the columns no child needs; to be called after the last set_box().
  void pad() {
    for (std::uint32_t c = count; c < kWidth; ++c) {
      set_box(c, box(0));
      child[c] = child[0];
    }
  }
};

using WideBvhNode = WideNode<kBvhWidth>;

/// Node 0 is the root, also of a single leaf; every child node has a higher index than its parent,
/// and leaves are numbered in the order the nodes list them, until they are rotated. No items: no
/// nodes.
struct WideBvh {
  std::vector<WideBvhNode> nodes;
  std::vector<std::uint32_t> items;  ///< kLeafItems per leaf, the last ones kNoItem where unused

  std::uint32_t leaf_count() const { return static_cast<std::uint32_t>(items.size() / kLeafItems); }
  std::span<const std::uint32_t, kLeafItems> leaf(std::uint32_t number) const {
    return std::span<const std::uint32_t, kLeafItems>(
        items.data() + std::size_t{number} * kLeafItems, kLeafItems);
  }
  std::size_t bytes() const {
    return nodes.size() * sizeof(WideBvhNode) + items.size() * sizeof(std::uint32_t);
  }
};

/// The wide hierarchy of least expected cost that can be made of a binary one by leaving nodes out
/// (Ylitie, Karras, Laine 2017). The leaves of `binary` have at most kLeafItems references. Cost:
/// O(N).
WideBvh collapse(const Bvh& binary);

/// A tree over `boxes` whose leaves hold as many items as are tested together. Boxes must be finite
/// and not empty. Cost: O(N log N). The result depends on the input alone.
WideBvh build_wide_bvh(std::span<const Aabb> boxes, int bins);

/// New boxes for the same items, bottom up. `boxes` has one per item. Cost: O(N); runs in parallel.
void refit_wide_bvh(WideBvh& bvh, std::span<const Aabb> boxes);

/// Tree rotations (Kensler 2008), for nodes of eight: one child of a node changes places with a
/// grandchild under another child, wherever that makes the other child's box smaller, bottom up.
/// What hangs together in this pose comes together; leaves keep their items and numbers. Never
/// raises sah_cost(), nor makes the tree deeper than kMaxBvhDepth. Returns how many changed places.
/// Cost: O(nodes), some tenths of a build.
std::size_t rotate_wide_bvh(WideBvh& bvh);

/// Expected boxes and leaves hit by a ray that hits the root's box (SAH). A root without area
/// counts as hit whole. Cost: O(nodes).
double sah_cost(const WideBvh& bvh);

/// The first fault found in a hierarchy over `boxes`, in words; empty where there is none. Sound:
/// every node and leaf is reached once, nodes from one before them and none deeper than
/// kMaxBvhDepth; every item is in one leaf; each box is the union of what is under it; columns and
/// places in leaves that are not used come last and are filled as they must be. Cost: O(N).
std::string validate(const WideBvh& bvh, std::span<const Aabb> boxes);

/// A small hierarchy over boxes, such as those of clusters in the world (Lo09 §4.3). One box a
/// leaf: leaf i holds box `box_of_leaf[i]`. Nodes as in a WideBvh. Empty boxes are left out.
struct TopLevel {
  std::vector<WideBvhNode> nodes;
  std::vector<std::uint32_t> box_of_leaf;

  std::size_t bytes() const {
    return nodes.size() * sizeof(WideBvhNode) + box_of_leaf.size() * sizeof(std::uint32_t);
  }
};

/// Splits at medians. Keeps the memory `top` has. Boxes must be finite or empty. Cost: O(K log K).
/// The result depends on the input alone.
void build_top_level(std::span<const Aabb> boxes, TopLevel& top);

/// As for a WideBvh: every box that is not empty has one leaf.
std::string validate(const TopLevel& top, std::span<const Aabb> boxes);

}  // namespace mdk
