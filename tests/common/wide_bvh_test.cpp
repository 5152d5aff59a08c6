// Wide hierarchies: every item in one leaf, boxes exact, links forward; the same after refitting.
#include "common/structures/wide_bvh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/base/parallel.h"
#include "common/structures/top_level.h"
#include "tests/common/random_boxes.h"

namespace mdk {
namespace {

using test::BoxScene;
using ::testing::Each;

/// Each node and leaf reached once and in order, each item in one leaf, each box exact.
void expect_sound(const WideBvh& bvh, const std::vector<Aabb>& boxes) {
  std::vector<int> times_reached(bvh.nodes.size(), 0), times_listed(boxes.size(), 0);
  std::uint32_t leaves = 0;
  times_reached[0] = 1;
  for (std::uint32_t i = 0; i < bvh.nodes.size(); ++i) {
    const WideBvhNode& node = bvh.nodes[i];
    ASSERT_GE(node.count, 1u);
    ASSERT_LE(node.count, kBvhWidth);
    for (std::uint32_t c = 0; c < kBvhWidth; ++c) {
      if (c >= node.count) {
        EXPECT_EQ(node.box(c), node.box(0)) << "an unused column must hold numbers";
        continue;
      }
      const std::uint32_t index = node.child[c].index();
      if (!node.child[c].is_leaf()) {
        ASSERT_GT(index, i);
        ASSERT_LT(index, bvh.nodes.size());
        ++times_reached[index];
        ASSERT_EQ(node.box(c), bvh.nodes[index].box());
        continue;
      }
      ASSERT_LT(index, bvh.leaf_count());
      ++leaves;
      Aabb exact;
      bool ended = false;
      for (const std::uint32_t item : bvh.leaf(index)) {
        ASSERT_FALSE(ended && item != kNoItem) << "items come first";
        ended = item == kNoItem;
        if (ended) continue;
        ++times_listed[item];
        exact.extend(boxes[item]);
      }
      ASSERT_EQ(node.box(c), exact);
    }
  }
  EXPECT_EQ(leaves, bvh.leaf_count());
  EXPECT_THAT(times_reached, Each(1));
  EXPECT_THAT(times_listed, Each(1));
}

class WideBvhOfScene : public ::testing::TestWithParam<BoxScene> {};

TEST_P(WideBvhOfScene, IsSound) {
  for (const int bins : {2, 16, 64})
    expect_sound(build_wide_bvh(GetParam().boxes, bins), GetParam().boxes);
}

TEST_P(WideBvhOfScene, IsSoundWithOneItemPerLeaf) {
  expect_sound(collapse(build_bvh(GetParam().boxes, {.max_leaf = 1})), GetParam().boxes);
}

TEST_P(WideBvhOfScene, IsSoundAfterItsBoxesMoveAndRefit) {
  std::vector<Aabb> boxes = GetParam().boxes;
  WideBvh bvh = build_wide_bvh(boxes, 16);
  const std::vector<std::uint32_t> items = bvh.items;
  test::Random random(61);
  for (Aabb& box : boxes)
    box =
        test::box_at(random.point({{-5, -5, -5}, {5, 5, 5}}), random.point({{0, 0, 0}, {1, 1, 1}}));
  refit_wide_bvh(bvh, boxes);
  expect_sound(bvh, boxes);
  EXPECT_EQ(bvh.items, items);
}

TEST_P(WideBvhOfScene, TopLevelHasEveryBoxInALeafOfItsOwn) {
  const std::vector<Aabb>& boxes = GetParam().boxes;
  TopLevel top;
  build_top_level(boxes, top);
  build_top_level(boxes, top);  // what an earlier frame left must not matter
  ASSERT_EQ(top.box_of_leaf.size(), boxes.size());
  std::vector<bool> seen(boxes.size(), false);
  for (const std::uint32_t box : top.box_of_leaf) seen[box] = true;
  EXPECT_THAT(seen, Each(true));
  for (const WideBvhNode& node : top.nodes)
    for (std::uint32_t c = 0; c < node.count; ++c)
      if (node.child[c].is_leaf()) {
        EXPECT_EQ(node.box(c), boxes[top.box_of_leaf[node.child[c].index()]]);
      } else {
        EXPECT_EQ(node.box(c), top.nodes[node.child[c].index()].box());
      }
}

INSTANTIATE_TEST_SUITE_P(AllScenes, WideBvhOfScene, ::testing::ValuesIn(test::box_scenes()),
                         test::SceneName());

TEST(WideBvh, OfNothingHasNoNodes) {
  EXPECT_TRUE(build_wide_bvh({}, 16).nodes.empty());
  WideBvh none;
  refit_wide_bvh(none, {});
  EXPECT_TRUE(none.nodes.empty());
}

TEST(WideBvh, FillsNodesAndLeaves) {
  const std::vector<Aabb> boxes = test::scattered_boxes(20000, 1, 0.02f, 62);
  const WideBvh bvh = build_wide_bvh(boxes, 16);
  EXPECT_GT(static_cast<double>(boxes.size()) / bvh.leaf_count(), 11.0);
  std::size_t children = 0;
  for (const WideBvhNode& node : bvh.nodes) children += node.count;
  EXPECT_GT(static_cast<double>(children) / static_cast<double>(bvh.nodes.size()), 5.0);
}

TEST(WideBvh, IsTheSameForEveryNumberOfThreads) {
  const std::vector<Aabb> boxes = test::scattered_boxes(30000, 1, 0.02f, 63);
  const auto build = [&](int threads) {
    const ThreadLimit limit(threads);
    return build_wide_bvh(boxes, 16);
  };
  const WideBvh one = build(1);
  for (const int threads : {2, 3}) {
    const WideBvh several = build(threads);
    ASSERT_EQ(several.items, one.items);
    ASSERT_EQ(several.nodes.size(), one.nodes.size());
    for (std::size_t i = 0; i < one.nodes.size(); ++i)
      for (std::uint32_t c = 0; c < kBvhWidth; ++c) {
        ASSERT_EQ(several.nodes[i].box(c), one.nodes[i].box(c));
        ASSERT_EQ(several.nodes[i].child[c].index(), one.nodes[i].child[c].index());
      }
  }
}

TEST(TopLevel, LeavesOutEmptyBoxes) {
  TopLevel top;
  build_top_level(std::vector<Aabb>{Aabb{}, {{0, 0, 0}, {1, 1, 1}}, Aabb{}}, top);
  EXPECT_EQ(top.box_of_leaf, std::vector<std::uint32_t>{1});
  build_top_level(std::vector<Aabb>(5), top);
  EXPECT_TRUE(top.nodes.empty());
}

}  // namespace
}  // namespace mdk
