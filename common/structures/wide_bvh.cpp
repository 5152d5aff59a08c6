// Making wide hierarchies: a binary one collapsed, or boxes halved into parts until a node has
// eight. Both are filled by one descent; what is put into a node is what differs.
#include "common/structures/wide_bvh.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <functional>
#include <utility>

#include "common/base/parallel.h"
#include "common/structures/link_check.h"
#include "common/structures/top_down.h"

namespace mdk {
namespace {

constexpr std::size_t kNodesPerChunk = 512;

/// What visiting a wide node and testing a leaf's block cost, in the same unit.
constexpr float kNodeCost = 1.0f;
constexpr float kLeafCost = 1.0f;

/// Up to eight parts of what is under a node.
template <class Part>
struct Parts {
  std::array<Part, kBvhWidth> part;
  std::uint32_t count = 0;

  void push(const Part& p) { part[count++] = p; }
  std::span<Part> all() { return {part.data(), count}; }
};

/// Fills a node and what is under it, depth first, and returns its index. Of `source`:
/// divide(part) gives the parts of a node, box_of(part) the box of one, is_leaf(part) whether it is
/// a leaf, whose number add_leaf(part) then gives.
template <class Source, class Part>
std::uint32_t fill_node(std::vector<WideBvhNode>& nodes, Source& source, const Part& whole) {
  const auto index = static_cast<std::uint32_t>(nodes.size());
  nodes.emplace_back();
  Parts<Part> parts = source.divide(whole);
  for (std::uint32_t c = 0; c < parts.count; ++c) {
    const Part& part = parts.part[c];
    const WideBvhChild child = source.is_leaf(part)
                                   ? WideBvhChild::leaf(source.add_leaf(part))
                                   : WideBvhChild::inner(fill_node(nodes, source, part));
    nodes[index].child[c] = child;
    nodes[index].set_box(c, source.box_of(part));
  }
  nodes[index].count = parts.count;
  nodes[index].pad();
  return index;
}

float cost_area(const BvhNode& node) {
  const float x = node.hi.x - node.lo.x, y = node.hi.y - node.lo.y, z = node.hi.z - node.lo.z;
  return x * y + (x + y) * z;
}

/// Bottom up, the smallest cost of standing for a binary node by at most i = 1...8 wide ones:
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
    fill_node(wide_.nodes, *this, 0u);
    return std::move(wide_);
  }

  // For fill_node(): parts are nodes of the binary tree.
  Parts<std::uint32_t> divide(std::uint32_t root) const {
    Parts<std::uint32_t> children;
    if (binary_.nodes[root].is_leaf()) {
      children.push(root);
    } else {
      share(root, plans_[root].own_left, kBvhWidth, children);
    }
    return children;
  }
  bool is_leaf(std::uint32_t node) const { return binary_.nodes[node].is_leaf(); }
  Aabb box_of(std::uint32_t node) const { return binary_.nodes[node].box(); }
  std::uint32_t add_leaf(std::uint32_t node) {
    const BvhNode& leaf = binary_.nodes[node];
    assert(leaf.count <= kLeafItems);
    const std::uint32_t number = wide_.leaf_count();
    const auto first = binary_.refs.begin() + leaf.first;
    wide_.items.insert(wide_.items.end(), first, first + leaf.count);
    wide_.items.resize((std::size_t{number} + 1) * kLeafItems, kNoItem);
    return number;
  }

 private:
  /// Entry i is for at most i wide nodes; index 0 is not used.
  struct Plan {
    std::array<float, kBvhWidth + 1> cost;
    std::array<std::uint8_t, kBvhWidth + 1> used;  ///< how many of i are made use of
    std::array<std::uint8_t, kBvhWidth + 1> left;  ///< of i in use, how many go to the first child
    std::uint8_t own_left = 0;                     ///< the same for the eight of its own wide node
  };

  void make_plan(std::size_t index) {
    const BvhNode& node = binary_.nodes[index];
    Plan& plan = plans_[index];
    if (node.is_leaf()) {
      plan.cost.fill(cost_area(node) * kLeafCost);
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
    plan.cost[1] = plan.cost[kBvhWidth] + cost_area(node) * kNodeCost;
    plan.used[1] = 1;
    for (std::size_t i = 2; i <= kBvhWidth; ++i) {
      const bool fewer_will_do = plan.cost[i - 1] <= plan.cost[i];
      plan.used[i] = fewer_will_do ? plan.used[i - 1] : static_cast<std::uint8_t>(i);
      if (fewer_will_do) plan.cost[i] = plan.cost[i - 1];
    }
  }

  /// Adds what stands for binary node `index` where there is room for `room`.
  void choose(std::uint32_t index, std::size_t room, Parts<std::uint32_t>& chosen) const {
    const Plan& plan = plans_[index];
    const std::size_t used = plan.used[room];
    if (used == 1) {
      chosen.push(index);
    } else {
      share(index, plan.left[used], used, chosen);
    }
  }
  void share(std::uint32_t index, std::size_t left, std::size_t room,
             Parts<std::uint32_t>& chosen) const {
    const std::uint32_t first = binary_.nodes[index].first;
    choose(first, left, chosen);
    choose(first + 1, room - left, chosen);
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

/// Runs of a top level's leaves.
struct LeafRun {
  std::uint32_t begin, end;

  std::uint32_t count() const { return end - begin; }
};

/// A node halves its largest part until it has eight; each part of more than one box is a node.
class MedianSplitter {
 public:
  MedianSplitter(std::span<const Aabb> boxes, std::span<std::uint32_t> box_of_leaf)
      : boxes_(boxes), box_of_leaf_(box_of_leaf) {}

  Parts<LeafRun> divide(const LeafRun& whole) {
    Parts<LeafRun> parts;
    parts.push(whole);
    while (parts.count < kBvhWidth) {
      LeafRun& largest = *std::ranges::max_element(parts.all(), {}, &LeafRun::count);
      if (largest.count() <= 1) break;
      const std::uint32_t middle = halve(largest);
      parts.push({middle, largest.end});
      largest.end = middle;
    }
    return parts;
  }
  bool is_leaf(const LeafRun& run) const { return run.count() == 1; }
  std::uint32_t add_leaf(const LeafRun& run) const { return run.begin; }
  Aabb box_of(const LeafRun& run) const {
    Aabb box;
    for (const std::uint32_t i : of(run)) box.extend(boxes_[i]);
    return box;
  }

 private:
  std::span<std::uint32_t> of(const LeafRun& run) const {
    return box_of_leaf_.subspan(run.begin, run.count());
  }

  std::uint32_t halve(const LeafRun& run) {
    const auto place_of = [&](std::uint32_t i, std::size_t axis) {
      return centroid(boxes_[i], axis);
    };
    Aabb centroids;
    for (const std::uint32_t i : of(run))
      centroids.extend(Vec3f{place_of(i, 0), place_of(i, 1), place_of(i, 2)});
    part_at_median(of(run), centroids, place_of, std::identity{});
    return run.begin + run.count() / 2;
  }

  std::span<const Aabb> boxes_;
  std::span<std::uint32_t> box_of_leaf_;
};

/// The first fault of nodes over `leaf_count` leaves; leaf_fault(leaf, box) tells what is wrong
/// with a leaf that has this box, if anything.
template <class LeafFault>
std::string find_fault(std::span<const WideBvhNode> all, std::size_t leaf_count,
                       const LeafFault& leaf_fault) {
  LinkCheck nodes("node", all.size(), kMaxBvhDepth), leaves("leaf", leaf_count);
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all[i].count < 1 || all[i].count > kBvhWidth)
      return nodes.name(i) + ": " + std::to_string(all[i].count) + " children";
  if (!all.empty()) nodes.reach(0);
  const auto fault_of = [&](std::size_t i) -> std::string {
    const WideBvhNode& node = all[i];
    if (!nodes.is_reached(i)) return "no node before it links to it";
    for (std::uint32_t c = 0; c < node.count; ++c) {
      const std::uint32_t child = node.child[c].index();
      std::string fault;
      if (node.child[c].is_leaf()) {
        fault = leaves.reach(child);
        if (fault.empty()) fault = leaf_fault(child, node.box(c));
      } else {
        fault = nodes.reach(child, nodes.depth(i) + 1);
        if (fault.empty() && node.box(c) != all[child].box())
          fault = "it has another box for " + nodes.name(child);
      }
      if (!fault.empty()) return fault;
    }
    for (std::uint32_t c = node.count; c < kBvhWidth; ++c)
      if (node.box(c) != node.box(0) || node.child[c].index() != node.child[0].index())
        return "column " + std::to_string(c) + " does not repeat the first one";
    return "";
  };
  for (std::size_t i = 0; i < all.size(); ++i)
    if (const std::string fault = fault_of(i); !fault.empty()) return nodes.name(i) + ": " + fault;
  return leaves.find_missing();
}

}  // namespace

WideBvh collapse(const Bvh& binary) { return Collapser(binary).run(); }

WideBvh build_wide_bvh(std::span<const Aabb> boxes, int bins) {
  WideBvh bvh =
      collapse(build_bvh(boxes, {.bins = bins, .max_leaf = kLeafItems, .block = kLeafItems}));
  assert(validate(bvh, boxes).empty());
  return bvh;
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
  const double root = half_area(bvh.nodes[0].box());
  double sum = 1;
  for (const WideBvhNode& node : bvh.nodes)
    for (std::uint32_t c = 0; c < node.count; ++c)
      sum += root > 0 ? half_area(node.box(c)) / root : 1;
  return sum;
}

std::string validate(const WideBvh& bvh, std::span<const Aabb> boxes) {
  LinkCheck items("item", boxes.size());
  const auto leaf_fault = [&](std::uint32_t number, const Aabb& box) -> std::string {
    const auto leaf = bvh.leaf(number);
    const auto end = std::ranges::find(leaf, kNoItem);
    for (auto item = leaf.begin(); item != end; ++item)
      if (std::string fault = items.reach(*item); !fault.empty()) return fault;
    if (std::find_if(end, leaf.end(), [](std::uint32_t i) { return i != kNoItem; }) != leaf.end())
      return "an item behind an unused place";
    return box == box_of_items(leaf, boxes) ? "" : "a leaf's box is not that of its items";
  };
  const std::string fault = find_fault(bvh.nodes, bvh.leaf_count(), leaf_fault);
  return fault.empty() ? items.find_missing() : fault;
}

void build_top_level(std::span<const Aabb> boxes, TopLevel& top) {
  top.nodes.clear();
  top.box_of_leaf.clear();
  for (std::uint32_t i = 0; i < boxes.size(); ++i)
    if (!boxes[i].empty()) top.box_of_leaf.push_back(i);
  if (top.box_of_leaf.empty()) return;
  MedianSplitter splitter(boxes, top.box_of_leaf);
  fill_node(top.nodes, splitter, LeafRun{0, static_cast<std::uint32_t>(top.box_of_leaf.size())});
  assert(validate(top, boxes).empty());
}

std::string validate(const TopLevel& top, std::span<const Aabb> boxes) {
  LinkCheck items("box", boxes.size());
  for (std::size_t i = 0; i < boxes.size(); ++i)
    if (boxes[i].empty()) items.reach(i);  // needs no leaf
  const auto leaf_fault = [&](std::uint32_t number, const Aabb& box) -> std::string {
    const std::uint32_t item = top.box_of_leaf[number];
    if (std::string fault = items.reach(item); !fault.empty()) return fault;
    return box == boxes[item] ? "" : "it has another box for " + items.name(item);
  };
  const std::string fault = find_fault(top.nodes, top.box_of_leaf.size(), leaf_fault);
  return fault.empty() ? items.find_missing() : fault;
}

}  // namespace mdk
