// Refitting, costing and checking a Bvh. Children have higher indices than their parent, so one
// backward pass is bottom up.
#include "common/structures/bvh.h"

#include <cassert>

#include "common/structures/link_check.h"

namespace mdk {
namespace {

/// The union of what is under a node.
Aabb box_under(const Bvh& bvh, const BvhNode& node, std::span<const Aabb> boxes) {
  Aabb box;
  if (node.is_leaf()) {
    for (std::uint32_t r = 0; r < node.count; ++r) box.extend(boxes[bvh.refs[node.first + r]]);
  } else {
    box = bvh.nodes[node.first].box();
    box.extend(bvh.nodes[node.first + 1].box());
  }
  return box;
}

}  // namespace

void refit_bvh(Bvh& bvh, std::span<const Aabb> boxes) {
  assert(bvh.refs.size() == boxes.size());
  for (std::size_t i = bvh.nodes.size(); i-- > 0;)
    bvh.nodes[i].set_box(box_under(bvh, bvh.nodes[i], boxes));
}

double sah_cost(const Bvh& bvh, const BvhBuildConfig& config) {
  if (bvh.nodes.empty()) return 0;
  const double root_area = half_area(bvh.nodes[0].box());
  double cost = 0;
  for (const BvhNode& node : bvh.nodes) {
    const double visit =
        node.is_leaf() ? static_cast<double>(config.intersect_cost * config.leaf_tests(node.count))
                       : static_cast<double>(config.traversal_cost);
    // A root without area is hit as a whole or not at all.
    cost += root_area > 0 ? visit * half_area(node.box()) / root_area : visit;
  }
  return cost;
}

std::string validate(const Bvh& bvh, std::span<const Aabb> boxes, std::uint32_t max_leaf) {
  LinkCheck nodes("node", bvh.nodes.size(), kMaxBvhDepth), items("item", boxes.size());
  if (!bvh.nodes.empty()) nodes.reach(0);
  const auto fault_of = [&](std::size_t i) -> std::string {
    const BvhNode& node = bvh.nodes[i];
    if (!nodes.is_reached(i)) return "no node before it links to it";
    if (node.is_leaf()) {
      if (node.count > max_leaf) return "a leaf of " + std::to_string(node.count) + " items";
      if (std::size_t{node.first} + node.count > bvh.refs.size()) return "a leaf past the end";
      for (std::uint32_t r = 0; r < node.count; ++r)
        if (std::string fault = items.reach(bvh.refs[node.first + r]); !fault.empty()) return fault;
    } else {
      for (const std::size_t child : {std::size_t{node.first}, std::size_t{node.first} + 1})
        if (std::string fault = nodes.reach(child, nodes.depth(i) + 1); !fault.empty())
          return fault;
    }
    return node.box() == box_under(bvh, node, boxes) ? "" : "its box is not that of its content";
  };
  for (std::size_t i = 0; i < bvh.nodes.size(); ++i)
    if (const std::string fault = fault_of(i); !fault.empty()) return nodes.name(i) + ": " + fault;
  return items.find_missing();
}

}  // namespace mdk
