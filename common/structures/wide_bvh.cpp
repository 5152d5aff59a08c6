#include "common/structures/wide_bvh.h"

#include <array>
#include <cassert>
#include <utility>

#include "common/base/parallel.h"

namespace mdk {
namespace {

constexpr std::size_t kNodesPerChunk = 512;

/// What visiting a wide node and testing a leaf's block cost, in the same unit.
constexpr float kNodeCost = 1.0f;
constexpr float kLeafCost = 1.0f;

float half_area(const BvhNode& node) {
  const float x = node.hi.x - node.lo.x, y = node.hi.y - node.lo.y, z = node.hi.z - node.lo.z;
  return x * y + (x + y) * z;
}

/// Bottom up, the least cost of standing for a binary node by at most i = 1...8 wide ones:
///
///     cost(n, 1) = a wide node over the best eight, or a leaf
///     cost(n, i) = the best way to share i between n's two children, or cost(n, i - 1)
class Collapser {
 public:
  explicit Collapser(const Bvh& binary) : binary_(binary), plans_(binary.nodes.size()) {}

  WideBvh run() {
    if (binary_.nodes.empty()) return {};
    for (std::size_t i = binary_.nodes.size(); i-- > 0;) make_plan(i);
    wide_.nodes.reserve(binary_.nodes.size() / kBvhWidth + 1);
    wide_.items.reserve((binary_.nodes.size() + 1) / 2 * kLeafItems);
    collapse_node(0);
    return std::move(wide_);
  }

 private:
  /// Entry i is for at most i wide nodes; index 0 is not used.
  struct Plan {
    std::array<float, kBvhWidth + 1> cost;
    std::array<std::uint8_t, kBvhWidth + 1> used;  ///< how many of i are made use of
    std::array<std::uint8_t, kBvhWidth + 1> left;  ///< of i in use, how many go to the first child
    std::uint8_t own_left = 0;                     ///< the same for the eight of its own wide node
  };
  struct Children {
    std::array<std::uint32_t, kBvhWidth> nodes;  ///< of the binary tree
    std::uint32_t count = 0;
  };

  void make_plan(std::size_t index) {
    const BvhNode& node = binary_.nodes[index];
    Plan& plan = plans_[index];
    if (node.is_leaf()) {
      plan.cost.fill(half_area(node) * kLeafCost);
      plan.used.fill(1);
      return;
    }
    const Plan &first = plans_[node.first], &second = plans_[node.first + 1];
    for (std::size_t i = 2; i <= kBvhWidth; ++i) {
      plan.cost[i] = first.cost[1] + second.cost[i - 1];
      plan.left[i] = 1;
      for (std::size_t k = 2; k < i; ++k) {
        const float cost = first.cost[k] + second.cost[i - k];
        if (!(cost < plan.cost[i])) continue;
        plan.cost[i] = cost;
        plan.left[i] = static_cast<std::uint8_t>(k);
      }
    }
    plan.own_left = plan.left[kBvhWidth];
    plan.cost[1] = plan.cost[kBvhWidth] + half_area(node) * kNodeCost;
    plan.used[1] = 1;
    for (std::size_t i = 2; i <= kBvhWidth; ++i) {
      const bool fewer_will_do = plan.cost[i - 1] <= plan.cost[i];
      plan.used[i] = fewer_will_do ? plan.used[i - 1] : static_cast<std::uint8_t>(i);
      if (fewer_will_do) plan.cost[i] = plan.cost[i - 1];
    }
  }

  /// Adds what stands for binary node `index` where there is room for `room`.
  void choose(std::uint32_t index, std::size_t room, Children& chosen) const {
    const Plan& plan = plans_[index];
    const std::size_t used = plan.used[room];
    if (used == 1) {
      chosen.nodes[chosen.count++] = index;
    } else {
      share(index, plan.left[used], used, chosen);
    }
  }
  void share(std::uint32_t index, std::size_t left, std::size_t room, Children& chosen) const {
    const std::uint32_t first = binary_.nodes[index].first;
    choose(first, left, chosen);
    choose(first + 1, room - left, chosen);
  }

  std::uint32_t collapse_node(std::uint32_t root) {
    const auto index = static_cast<std::uint32_t>(wide_.nodes.size());
    wide_.nodes.emplace_back();
    Children children;
    if (binary_.nodes[root].is_leaf()) {
      children.nodes[children.count++] = root;
    } else {
      share(root, plans_[root].own_left, kBvhWidth, children);
    }
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
  std::vector<Plan> plans_;  ///< by node of the binary tree
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
  return collapse(build_bvh(boxes, {.bins = bins, .max_leaf = kLeafItems, .block = kLeafItems}));
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

double sah_cost(const WideBvh& bvh) {
  if (bvh.nodes.empty()) return 0;
  const auto half_area = [](const Aabb& box) {
    const Vec3d e = to_double(box.hi) - to_double(box.lo);
    return e.x * e.y + e.y * e.z + e.z * e.x;
  };
  const double root = half_area(bvh.nodes[0].box());
  double sum = 1;
  for (const WideBvhNode& node : bvh.nodes)
    for (std::uint32_t c = 0; c < node.count; ++c)
      sum += root > 0 ? half_area(node.box(c)) / root : 1;
  return sum;
}

}  // namespace mdk
