// kd-trees of every kind of scene: each box is covered by the leaves that list it, a walk finds
// what brute force finds, size stays within bounds.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <functional>

#include "common/structures/kd_tree.h"
#include "tests/common/random_boxes.h"

namespace mdk {
namespace {

using test::BoxScene;
using test::Random;

/// Calls visit(leaf) for every leaf whose closed cell overlaps `query`.
void for_each_leaf(const KdTree& tree, const Aabb& query,
                   const std::function<void(const KdNode&)>& visit) {
  const std::function<void(std::uint32_t, const Aabb&)> descend = [&](std::uint32_t index,
                                                                      const Aabb& cell) {
    if (!test::overlap(cell, query)) return;
    const KdNode& node = tree.nodes[index];
    if (node.is_leaf()) return visit(node);
    Aabb below = cell, above = cell;
    below.hi[node.axis()] = above.lo[node.axis()] = node.split();
    descend(node.below(), below);
    descend(node.above(), above);
  };
  descend(0, tree.bounds);
}

std::span<const std::uint32_t> refs_of(const KdTree& tree, const KdNode& leaf) {
  return std::span(tree.refs).subspan(leaf.first_ref(), leaf.ref_count());
}

bool lists(const KdTree& tree, const KdNode& leaf, std::uint32_t item) {
  const auto refs = refs_of(tree, leaf);
  return std::find(refs.begin(), refs.end(), item) != refs.end();
}

std::vector<std::uint32_t> found_by_walking(const KdTree& tree, const std::vector<Aabb>& boxes,
                                            const Aabb& query) {
  std::vector<std::uint32_t> found;
  for_each_leaf(tree, query, [&](const KdNode& leaf) {
    for (const std::uint32_t item : refs_of(tree, leaf))
      if (test::overlap(boxes[item], query)) found.push_back(item);
  });
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

std::vector<std::uint32_t> found_by_force(const std::vector<Aabb>& boxes, const Aabb& query) {
  std::vector<std::uint32_t> found;
  for (std::uint32_t i = 0; i < boxes.size(); ++i)
    if (test::overlap(boxes[i], query)) found.push_back(i);
  return found;
}

class KdTreeOfScene : public ::testing::TestWithParam<BoxScene> {};

TEST_P(KdTreeOfScene, IsSoundAndNotTooLarge) {
  const std::vector<Aabb>& boxes = GetParam().boxes;
  const KdTree tree = build_kd_tree(boxes);
  EXPECT_EQ(validate(tree.view(), boxes), "");
  EXPECT_LE(tree.refs.size(), 8 * boxes.size());
}

TEST_P(KdTreeOfScene, CoversEveryPointOfEveryBoxByALeafThatListsIt) {
  const std::vector<Aabb>& boxes = GetParam().boxes;
  const KdTree tree = build_kd_tree(boxes);
  std::array<std::vector<float>, 3> planes;
  for (const KdNode& node : tree.nodes)
    if (!node.is_leaf()) planes[node.axis()].push_back(node.split());

  const std::uint64_t seed = 41;
  Random random(seed);
  // Points inside, on faces, edges and corners, and on split planes, in every combination.
  const auto coordinate = [&](const Aabb& box, std::size_t axis) {
    const float lo = box.lo[axis], hi = box.hi[axis];
    switch (random.below(5)) {
      case 0:
        return lo;
      case 1:
        return hi;
      case 2:
        return random.between(lo, hi);
      default:
        if (planes[axis].empty()) return lo;
        return std::clamp(planes[axis][random.below(planes[axis].size())], lo, hi);
    }
  };
  for (std::uint32_t item = 0; item < boxes.size(); ++item)
    for (int k = 0; k < 60; ++k) {
      const Vec3f p{coordinate(boxes[item], 0), coordinate(boxes[item], 1),
                    coordinate(boxes[item], 2)};
      bool covered = false;
      for_each_leaf(tree, {p, p},
                    [&](const KdNode& leaf) { covered = covered || lists(tree, leaf, item); });
      ASSERT_TRUE(covered) << "seed " << seed << " item " << item << " at " << p.x << ' ' << p.y
                           << ' ' << p.z;
    }
}

TEST_P(KdTreeOfScene, FindsTheSameBoxesAsBruteForce) {
  const std::vector<Aabb>& boxes = GetParam().boxes;
  const KdTree tree = build_kd_tree(boxes);
  const std::uint64_t seed = 42;
  Random random(seed);
  for (int k = 0; k < 200; ++k) {
    const Aabb query = test::random_query(random, tree.bounds);
    ASSERT_EQ(found_by_walking(tree, boxes, query), found_by_force(boxes, query))
        << "seed " << seed << " query " << k;
  }
}

TEST_P(KdTreeOfScene, IsNeverMoreExpensiveThanOneLeaf) {
  const std::vector<Aabb>& boxes = GetParam().boxes;
  const KdBuildConfig config;
  const double one_leaf = static_cast<double>(config.intersect_cost) * boxes.size();
  const double cost = sah_cost(build_kd_tree(boxes).view(), config);
  EXPECT_GT(cost, 0);
  // A split that cuts off empty space may cost 1 / bonus of what it saves.
  EXPECT_LE(cost, one_leaf / config.empty_bonus * (1 + 1e-12));
}

TEST_P(KdTreeOfScene, IsTheSameEveryTimeAndForEveryOrderOfTheBoxes) {
  const std::vector<Aabb>& boxes = GetParam().boxes;
  const KdTree tree = build_kd_tree(boxes), again = build_kd_tree(boxes);
  const auto bits = [](const KdTree& t) {
    std::vector<std::uint64_t> words;
    for (const KdNode& n : t.nodes) words.push_back(std::uint64_t{n.word0} << 32 | n.word1);
    return words;
  };
  EXPECT_EQ(bits(tree), bits(again));
  EXPECT_EQ(tree.refs, again.refs);

  const std::vector<Aabb> reversed(boxes.rbegin(), boxes.rend());
  KdTree mirror = build_kd_tree(reversed);
  EXPECT_EQ(bits(tree), bits(mirror));
  for (std::uint32_t& ref : mirror.refs) ref = static_cast<std::uint32_t>(boxes.size() - 1) - ref;
  for (const KdNode& node : mirror.nodes)
    if (node.is_leaf())
      std::sort(mirror.refs.begin() + node.first_ref(),
                mirror.refs.begin() + node.first_ref() + node.ref_count());
  EXPECT_EQ(tree.refs, mirror.refs);
}

INSTANTIATE_TEST_SUITE_P(AllScenes, KdTreeOfScene, ::testing::ValuesIn(test::box_scenes()),
                         test::SceneName());

}  // namespace
}  // namespace mdk
