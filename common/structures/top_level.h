// TopLevel: a small hierarchy over the clusters' world boxes, made anew for every frame by median
// splits (Lo09 §4.3).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/structures/wide_bvh.h"

namespace mdk {

/// One box a leaf: leaf i holds box `box_of_leaf[i]`. Empty boxes are left out.
struct TopLevel {
  std::vector<WideBvhNode> nodes;
  std::vector<std::uint32_t> box_of_leaf;

  std::size_t bytes() const {
    return nodes.size() * sizeof(WideBvhNode) + box_of_leaf.size() * sizeof(std::uint32_t);
  }
};

/// Keeps the memory `top` has. Boxes must be finite or empty. Cost: O(K log K). The result depends
/// on the input alone.
void build_top_level(std::span<const Aabb> boxes, TopLevel& top);

}  // namespace mdk
