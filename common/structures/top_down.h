// The one descent of all builders: from the root on, a part of the items at a time is offered to a
// splitter, which divides it in two or lets it be a leaf. Builders differ in their splitters alone.
//
//     nodes:  root | below, above | children of below | all under them | children of above | ...
#pragma once

#include <algorithm>
#include <concepts>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "common/math/aabb.h"

namespace mdk {

/// What a builder adds to the descent. `Part` is a node's share of the items, `Split` what came of
/// dividing one, with the members `below` and `above`. A part is made a leaf right after try_split
/// has given nothing for it; all under `below` is built before `above` is looked at.
template <class S, class Node>
concept Splitter = requires(S& s, const typename S::Part& part, const typename S::Split& split,
                            std::uint32_t children) {
  { s.try_split(part) } -> std::same_as<std::optional<typename S::Split>>;
  { s.make_inner(part, split, children) } -> std::same_as<Node>;
  { s.make_leaf(part) } -> std::same_as<Node>;
};

/// The nodes of a binary tree over `whole`: node 0 is the root, children lie side by side, behind
/// their parent. `expected` is how many nodes room is made for.
template <class Node, Splitter<Node> S>
std::vector<Node> build_top_down(S& splitter, const typename S::Part& whole, std::size_t expected) {
  struct Waiting {
    std::uint32_t node;
    typename S::Part part;
  };
  std::vector<Node> nodes;
  nodes.reserve(expected);
  nodes.resize(1);
  std::vector<Waiting> waiting{{0, whole}};
  while (!waiting.empty()) {
    const Waiting at = waiting.back();
    waiting.pop_back();
    const std::optional<typename S::Split> split = splitter.try_split(at.part);
    if (!split) {
      nodes[at.node] = splitter.make_leaf(at.part);
      continue;
    }
    const auto children = static_cast<std::uint32_t>(nodes.size());
    nodes[at.node] = splitter.make_inner(at.part, *split, children);
    nodes.resize(children + 2u);
    waiting.push_back({children + 1, split->above});
    waiting.push_back({children, split->below});
  }
  return nodes;
}

/// Halved before they are added, so that the sum stays in the range of float.
inline float centroid(const Aabb& box, std::size_t axis) {
  return box.lo[axis] * 0.5f + box.hi[axis] * 0.5f;
}

/// Orders items so that the lower half comes first, along the axis in which `centroids`, the box of
/// their centroids, is widest; equal centroids are told apart by number. `place_of(item, axis)`
/// gives an item's centroid, `number_of(item)` its number. Cost: O(N).
template <class Item, class PlaceOf, class NumberOf>
void part_at_median(std::span<Item> items, const Aabb& centroids, const PlaceOf& place_of,
                    const NumberOf& number_of) {
  const Vec3f extent = centroids.extent();
  std::size_t axis = 0;
  for (std::size_t a = 1; a < 3; ++a)
    if (extent[a] > extent[axis]) axis = a;
  std::nth_element(items.begin(), items.begin() + static_cast<std::ptrdiff_t>(items.size() / 2),
                   items.end(), [&](const Item& a, const Item& b) {
                     return std::pair(place_of(a, axis), number_of(a)) <
                            std::pair(place_of(b, axis), number_of(b));
                   });
}

}  // namespace mdk
