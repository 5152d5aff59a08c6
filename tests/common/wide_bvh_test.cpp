// Wide hierarchies and top levels: every item in one leaf, boxes exact, links forward; the same
// after refitting; and their checks find what is broken.
#include "common/structures/wide_bvh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "common/base/parallel.h"
#include "tests/common/random_boxes.h"

namespace mdk {
namespace {

using test::BoxScene;

class WideBvhOfScene : public ::testing::TestWithParam<BoxScene> {};

TEST_P(WideBvhOfScene, IsSound) {
  for (const int bins : {2, 16, 64})
    EXPECT_EQ(validate(build_wide_bvh(GetParam().boxes, bins), GetParam().boxes), "") << bins;
}

TEST_P(WideBvhOfScene, IsSoundWithOneItemPerLeaf) {
  EXPECT_EQ(validate(collapse(build_bvh(GetParam().boxes, {.max_leaf = 1})), GetParam().boxes), "");
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
  EXPECT_EQ(validate(bvh, boxes), "");
  EXPECT_EQ(bvh.items, items);
}

TEST_P(WideBvhOfScene, RefitsToItselfWhereNothingMoved) {
  WideBvh bvh = build_wide_bvh(GetParam().boxes, 16);
  for (WideBvhNode& node : bvh.nodes) node.set_box(0, {{-9, -9, -9}, {-8, -8, -8}});
  refit_wide_bvh(bvh, GetParam().boxes);
  EXPECT_EQ(validate(bvh, GetParam().boxes), "");
}

TEST_P(WideBvhOfScene, IsSoundAndNoDearerAfterRotations) {
  std::vector<Aabb> boxes = GetParam().boxes;
  WideBvh bvh = build_wide_bvh(boxes, 16);
  test::Random random(62);
  for (int frame = 0; frame < 20; ++frame) {
    for (Aabb& box : boxes) {
      const Vec3f step = random.point({{-1, -1, -1}, {1, 1, 1}});
      box = {box.lo + step, box.hi + step};
    }
    refit_wide_bvh(bvh, boxes);
    const double before = sah_cost(bvh);
    rotate_wide_bvh(bvh);
    ASSERT_EQ(validate(bvh, boxes), "") << "frame " << frame;
    EXPECT_LE(sah_cost(bvh), before * (1 + 1e-6));
  }
}

TEST_P(WideBvhOfScene, TopLevelHasEveryBoxInALeafOfItsOwn) {
  const std::vector<Aabb>& boxes = GetParam().boxes;
  TopLevel top;
  build_top_level(boxes, top);
  build_top_level(boxes, top);  // what an earlier frame left must not matter
  EXPECT_EQ(validate(top, boxes), "");
}

INSTANTIATE_TEST_SUITE_P(AllScenes, WideBvhOfScene, ::testing::ValuesIn(test::box_scenes()),
                         test::SceneName());

TEST(WideBvh, OfNothingHasNoNodes) {
  EXPECT_TRUE(build_wide_bvh({}, 16).nodes.empty());
  WideBvh none;
  refit_wide_bvh(none, {});
  EXPECT_TRUE(none.nodes.empty());
}

/// Three full nodes' worth of leaves with one item each.
struct SmallWideBvh {
  std::vector<Aabb> boxes;
  WideBvh bvh;

  SmallWideBvh() {
    for (int i = 0; i < 20; ++i) boxes.push_back(test::box_at({float(i) * 10, 0, 0}, {1, 1, 1}));
    bvh = collapse(build_bvh(boxes, {.traversal_cost = 0, .max_leaf = 1}));
  }
  /// The first child of the root that is a leaf, or is not one.
  WideBvhChild& child_of_root(bool is_leaf) {
    return *std::ranges::find(bvh.nodes[0].child, is_leaf, &WideBvhChild::is_leaf);
  }
  std::string fault() const { return validate(bvh, boxes); }
};

TEST(WideBvhCheck, FindsEachKindOfFault) {
  using Break = std::function<void(SmallWideBvh&)>;
  const std::pair<const char*, Break> faults[] = {
      {"has another box for node",
       [](SmallWideBvh& s) { s.bvh.nodes[s.child_of_root(false).index()].bounds[1][0] += 1000; }},
      {"a leaf's box is not that of its items", [](SmallWideBvh& s) { s.boxes[7].lo.y = -1; }},
      {"not the first to link to node 0",
       [](SmallWideBvh& s) { s.child_of_root(false) = WideBvhChild::inner(0); }},
      {"links to node 99, which there is not",
       [](SmallWideBvh& s) { s.child_of_root(false) = WideBvhChild::inner(99); }},
      {"no node before it links to it",
       [](SmallWideBvh& s) { s.bvh.nodes.push_back(s.bvh.nodes[0]); }},
      {"links to leaf 99, which there is not",
       [](SmallWideBvh& s) { s.child_of_root(false) = WideBvhChild::leaf(99); }},
      {"nothing links to leaf 20",
       [](SmallWideBvh& s) { s.bvh.items.resize(s.bvh.items.size() + kLeafItems, kNoItem); }},
      {"0 children", [](SmallWideBvh& s) { s.bvh.nodes.back().count = 0; }},
      {"9 children", [](SmallWideBvh& s) { s.bvh.nodes.back().count = 9; }},
      {"column 7 does not repeat the first one",
       [](SmallWideBvh& s) {
         WideBvhNode& node = *std::ranges::find_if(
             s.bvh.nodes, [](const WideBvhNode& n) { return n.count < kBvhWidth; });
         node.bounds[0][7] -= 1;
       }},
      {"links to item 99, which there is not", [](SmallWideBvh& s) { s.bvh.items[0] = 99; }},
      {"not the first to link to item", [](SmallWideBvh& s) { s.bvh.items[1] = s.bvh.items[0]; }},
      {"an item behind an unused place", [](SmallWideBvh& s) { s.bvh.items[2] = 0; }},
      {"nothing links to item 20", [](SmallWideBvh& s) { s.boxes.push_back(s.boxes[0]); }},
  };
  EXPECT_EQ(SmallWideBvh().fault(), "");
  for (const auto& [fault, break_it] : faults) {
    SmallWideBvh broken;
    break_it(broken);
    EXPECT_NE(broken.fault().find(fault), std::string::npos) << broken.fault() << " for " << fault;
  }
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

TEST(WideBvhCost, IsThatOfTheFormulaOnAHandMadeTree) {
  WideBvh bvh;
  bvh.nodes.resize(2);
  bvh.nodes[0].set_box(0, {{0, 0, 0}, {1, 1, 1}});  // area 6
  bvh.nodes[0].child[0] = WideBvhChild::leaf(0);
  bvh.nodes[0].set_box(1, {{2, 0, 0}, {4, 1, 1}});  // area 10
  bvh.nodes[0].child[1] = WideBvhChild::inner(1);
  bvh.nodes[0].count = 2;
  bvh.nodes[1].set_box(0, {{2, 0, 0}, {4, 1, 1}});
  bvh.nodes[1].child[0] = WideBvhChild::leaf(1);
  bvh.nodes[1].count = 1;
  EXPECT_NEAR(sah_cost(bvh), 1 + (6 + 10 + 10) / 18.0, 1e-12);
  EXPECT_EQ(sah_cost(WideBvh{}), 0);
}

TEST(WideBvhRotations, BringTogetherWhatHasComeTogether) {
  // Many small crowds, each about a leaf, that all go somewhere else.
  constexpr int kCrowds = 256, kInCrowd = 12;
  test::Random random(63);
  const Aabb everywhere{{0, 0, 0}, {100, 100, 100}}, nearby{{0, 0, 0}, {1, 1, 1}};
  std::vector<Aabb> boxes;
  for (int crowd = 0; crowd < kCrowds; ++crowd) {
    const Vec3f place = random.point(everywhere);
    for (int i = 0; i < kInCrowd; ++i)
      boxes.push_back(test::box_at(place + random.point(nearby), {0.1f, 0.1f, 0.1f}));
  }
  WideBvh bvh = build_wide_bvh(boxes, 16);
  for (int crowd = 0; crowd < kCrowds; ++crowd) {
    const Vec3f step = random.point(everywhere) - random.point(everywhere);
    for (int i = 0; i < kInCrowd; ++i) {
      Aabb& box = boxes[static_cast<std::size_t>(crowd * kInCrowd + i)];
      box = {box.lo + step, box.hi + step};
    }
  }
  refit_wide_bvh(bvh, boxes);
  const double worn = sah_cost(bvh);
  ASSERT_GT(worn, 2 * sah_cost(build_wide_bvh(boxes, 16)));
  while (rotate_wide_bvh(bvh) > 0) {
  }
  EXPECT_EQ(validate(bvh, boxes), "");
  EXPECT_LT(sah_cost(bvh), 0.7 * worn);
}

TEST(WideBvhRotations, NeverMakeATreeTooDeep) {
  // A chain as deep as may be: a node of two leaves, over and over; rotations could only lengthen
  // it.
  std::vector<Aabb> boxes;
  WideBvh bvh;
  for (std::uint32_t i = 0; i <= kMaxBvhDepth; ++i) {
    WideBvhNode& node = bvh.nodes.emplace_back();
    const bool is_last = i == kMaxBvhDepth;
    node.child[0] = WideBvhChild::leaf(i);
    node.child[1] = is_last ? WideBvhChild::leaf(i + 1) : WideBvhChild::inner(i + 1);
    node.count = 2;
  }
  test::Random random(64);
  for (std::uint32_t i = 0; i < kMaxBvhDepth + 2; ++i) {
    boxes.push_back(test::box_at(random.point({{0, 0, 0}, {10, 10, 10}}), {1, 1, 1}));
    bvh.items.push_back(i);
    bvh.items.resize((std::size_t{i} + 1) * kLeafItems, kNoItem);
  }
  refit_wide_bvh(bvh, boxes);
  ASSERT_EQ(validate(bvh, boxes), "");
  std::size_t turns = 0;
  for (int pass = 0; pass < 50; ++pass) turns += rotate_wide_bvh(bvh);
  EXPECT_EQ(validate(bvh, boxes), "");
  EXPECT_GT(turns, 0u);
}

TEST(WideBvhCost, GrowsWhenItemsMoveApart) {
  std::vector<Aabb> boxes = test::scattered_boxes(500, 1, 0.02f, 55);
  WideBvh bvh = build_wide_bvh(boxes, 16);
  const double before = sah_cost(bvh);
  std::reverse(boxes.begin(), boxes.end());  // every box goes where another one was
  refit_wide_bvh(bvh, boxes);
  EXPECT_GT(sah_cost(bvh), 2 * before);
}

TEST(TopLevel, LeavesOutEmptyBoxes) {
  TopLevel top;
  build_top_level(std::vector<Aabb>{Aabb{}, {{0, 0, 0}, {1, 1, 1}}, Aabb{}}, top);
  EXPECT_EQ(top.box_of_leaf, std::vector<std::uint32_t>{1});
  EXPECT_EQ(validate(top, std::vector<Aabb>{Aabb{}, {{0, 0, 0}, {1, 1, 1}}, Aabb{}}), "");
  build_top_level(std::vector<Aabb>(5), top);
  EXPECT_TRUE(top.nodes.empty());
}

TEST(TopLevelCheck, FindsEachKindOfFault) {
  const std::vector<Aabb> boxes = test::scattered_boxes(30, 1, 0.1f, 64);
  TopLevel top;
  build_top_level(boxes, top);
  ASSERT_EQ(validate(top, boxes), "");
  TopLevel twice = top;
  twice.box_of_leaf[1] = twice.box_of_leaf[0];
  EXPECT_NE(validate(twice, boxes).find("not the first to link to box"), std::string::npos);
  TopLevel unlinked = top;
  unlinked.box_of_leaf.push_back(0);
  EXPECT_EQ(validate(unlinked, boxes), "nothing links to leaf 30");
  std::vector<Aabb> other = boxes;
  other[3].hi.x += 1;
  EXPECT_NE(validate(top, other).find("another box for box 3"), std::string::npos);
  other = boxes;
  other.push_back(boxes[0]);
  EXPECT_EQ(validate(top, other), "nothing links to box 30");
  other.back() = Aabb{};
  EXPECT_EQ(validate(top, other), "");
}

}  // namespace
}  // namespace mdk
