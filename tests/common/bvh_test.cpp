// Bvh: built and checked. Boxes hold what is under them, exactly, and stay within
// depth and leaf size on every kind of scene.
#include "common/structures/bvh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numeric>

#include "common/structures/wide_bvh.h"
#include "tests/common/random_boxes.h"

namespace mdk {
namespace {

using test::box_at;
using test::BoxScene;
using test::Random;
using ::testing::ElementsAre;

std::vector<std::uint32_t> found_by_walking(const Bvh& bvh, const std::vector<Aabb>& boxes,
                                            const Aabb& query) {
  std::vector<std::uint32_t> found, stack{0};
  while (!stack.empty()) {
    const BvhNode& node = bvh.nodes[stack.back()];
    stack.pop_back();
    if (!test::overlap(node.box(), query)) continue;
    if (!node.is_leaf()) {
      stack.insert(stack.end(), {node.first, node.first + 1});
      continue;
    }
    for (std::uint32_t r = 0; r < node.count; ++r)
      if (test::overlap(boxes[bvh.refs[node.first + r]], query))
        found.push_back(bvh.refs[node.first + r]);
  }
  std::sort(found.begin(), found.end());
  return found;
}

std::vector<std::uint32_t> found_by_force(const std::vector<Aabb>& boxes, const Aabb& query) {
  std::vector<std::uint32_t> found;
  for (std::uint32_t i = 0; i < boxes.size(); ++i)
    if (test::overlap(boxes[i], query)) found.push_back(i);
  return found;
}

class BvhOfScene : public ::testing::TestWithParam<BoxScene> {};

TEST_P(BvhOfScene, IsSoundForEveryNumberOfBinsAndLeafSize) {
  for (const int bins : {2, 3, 16, 1024})
    for (const std::uint32_t max_leaf : {1u, 8u}) {
      SCOPED_TRACE(testing::Message() << bins << " bins, leaves up to " << max_leaf);
      BvhBuildConfig config;
      config.bins = bins;
      config.max_leaf = max_leaf;
      EXPECT_EQ(validate(build_bvh(GetParam().boxes, config), GetParam().boxes, max_leaf), "");
    }
}

TEST_P(BvhOfScene, FindsTheSameBoxesAsBruteForce) {
  const std::vector<Aabb>& boxes = GetParam().boxes;
  const Bvh bvh = build_bvh(boxes);
  const std::uint64_t seed = 51;
  Random random(seed);
  for (int k = 0; k < 200; ++k) {
    const Aabb query = test::random_query(random, bvh.nodes[0].box());
    ASSERT_EQ(found_by_walking(bvh, boxes, query), found_by_force(boxes, query))
        << "seed " << seed << " query " << k;
  }
}

TEST_P(BvhOfScene, IsTheSameEveryTime) {
  const std::vector<Aabb>& boxes = GetParam().boxes;
  const auto shape = [](const Bvh& bvh) {
    std::vector<std::tuple<std::uint32_t, std::uint32_t, float, float>> nodes;
    for (const BvhNode& n : bvh.nodes) nodes.emplace_back(n.first, n.count, n.lo.x, n.hi.z);
    return nodes;
  };
  const Bvh bvh = build_bvh(boxes), again = build_bvh(boxes);
  EXPECT_EQ(shape(bvh), shape(again));
  EXPECT_EQ(bvh.refs, again.refs);
}

INSTANTIATE_TEST_SUITE_P(AllScenes, BvhOfScene, ::testing::ValuesIn(test::box_scenes()),
                         test::SceneName());

TEST(Bvh, OfNothingHasNoNodes) {
  const Bvh bvh = build_bvh({});
  EXPECT_TRUE(bvh.nodes.empty());
  EXPECT_TRUE(bvh.refs.empty());
  EXPECT_EQ(validate(bvh, {}, 8), "");
}

TEST(Bvh, SplitsTwoPilesBetweenThem) {
  // Piles of three, far apart along y, their items interleaved in the input.
  std::vector<Aabb> boxes;
  for (int i = 0; i < 6; ++i)
    boxes.push_back(box_at({float(i), i % 2 == 0 ? 0.0f : 50.0f, 0}, {1, 1, 1}));
  BvhBuildConfig config;
  config.max_leaf = 3;
  config.traversal_cost = 4;  // nothing is gained under the first split
  const Bvh bvh = build_bvh(boxes, config);
  ASSERT_EQ(bvh.nodes.size(), 3u);
  EXPECT_EQ(bvh.nodes[0].first, 1u);
  EXPECT_THAT(bvh.refs, ElementsAre(0, 2, 4, 1, 3, 5));
  EXPECT_EQ(bvh.nodes[1].box(), (Aabb{{0, 0, 0}, {5, 1, 1}}));
  EXPECT_EQ(bvh.nodes[2].box(), (Aabb{{1, 50, 0}, {6, 51, 1}}));
}

TEST(Bvh, MakesALeafWhereThatIsCheaper) {
  std::vector<Aabb> boxes;
  for (int i = 0; i < 4; ++i) boxes.push_back(box_at({float(i) * 0.01f, 0, 0}, {1, 1, 1}));
  EXPECT_EQ(build_bvh(boxes).nodes.size(), 1u);
  BvhBuildConfig cheap_steps;
  cheap_steps.traversal_cost = 0;
  cheap_steps.intersect_cost = 1;
  for (std::size_t i = 0; i < 4; ++i) boxes[i] = box_at({float(i) * 10, 0, 0}, {1, 1, 1});
  EXPECT_EQ(build_bvh(boxes, cheap_steps).nodes.size(), 7u);
}

TEST(Bvh, HasTheSameShapeForEveryOrderOfItemsThatBinsTellApart) {
  const std::vector<Aabb> boxes = test::scattered_boxes(2000, 1, 0.02f, 56);
  const Bvh bvh = build_bvh(boxes);
  const Bvh mirror = build_bvh(std::vector<Aabb>(boxes.rbegin(), boxes.rend()));
  ASSERT_EQ(bvh.nodes.size(), mirror.nodes.size());
  for (std::size_t i = 0; i < bvh.nodes.size(); ++i) {
    ASSERT_EQ(bvh.nodes[i].box(), mirror.nodes[i].box());
    ASSERT_EQ(bvh.nodes[i].first, mirror.nodes[i].first);
    ASSERT_EQ(bvh.nodes[i].count, mirror.nodes[i].count);
  }
}

TEST(Bvh, SplitsLargeLeavesEvenAtALoss) {
  const std::vector<Aabb> boxes(100, box_at({0, 0, 0}, {1, 1, 1}));
  EXPECT_EQ(validate(build_bvh(boxes), boxes, 8), "");
}

/// The cheapest split by the book, over all orders by centroid: what enough bins must find.
double cheapest_by_force(const std::vector<Aabb>& boxes) {
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const Aabb& pivot : boxes) {
      Aabb below, above;
      int below_count = 0, above_count = 0;
      for (const Aabb& box : boxes) {
        const bool first = box.center()[axis] < pivot.center()[axis];
        (first ? below : above).extend(box);
        ++(first ? below_count : above_count);
      }
      if (below_count == 0 || above_count == 0) continue;
      best = std::min(best, static_cast<double>(surface_area(below)) * below_count +
                                static_cast<double>(surface_area(above)) * above_count);
    }
  return best;
}

TEST(Bvh, WithManyBinsFindsTheBestSplitOfAFew) {
  const std::uint64_t seed = 53;
  Random random(seed);
  for (int round = 0; round < 200; ++round) {
    // Centroids on a lattice of eighths: bins tell any two of them apart.
    std::vector<Aabb> boxes;
    const std::size_t count = 9 + random.below(20);
    for (std::size_t i = 0; i < count; ++i) {
      const auto at = [&] { return static_cast<float>(random.below(9)) * 0.125f; };
      const auto half = [&] { return static_cast<float>(random.below(4)) * 0.0625f; };
      const Vec3f center{at(), at(), at()}, r{half(), half(), half()};
      boxes.push_back({center - r, center + r});
    }
    BvhBuildConfig config;
    config.bins = 1024;
    config.max_leaf = 1;
    const Bvh bvh = build_bvh(boxes, config);
    double cost = 0;
    for (const std::uint32_t child : {1u, 2u}) {
      std::vector<std::uint32_t> stack{child};
      std::uint32_t items = 0;
      while (!stack.empty()) {
        const BvhNode& node = bvh.nodes[stack.back()];
        stack.pop_back();
        if (node.is_leaf())
          items += node.count;
        else
          stack.insert(stack.end(), {node.first, node.first + 1});
      }
      cost += static_cast<double>(surface_area(bvh.nodes[child].box())) * items;
    }
    const double best = cheapest_by_force(boxes);
    ASSERT_NEAR(cost, best, 1e-5 * best) << "seed " << seed << " round " << round;
  }
}

TEST(Bvh, IsCheaperWithMoreBins) {
  const std::vector<Aabb> boxes = test::scattered_boxes(20000, 1, 0.01f, 54);
  double last = std::numeric_limits<double>::infinity();
  for (const int bins : {2, 16, 1024}) {
    BvhBuildConfig config;
    config.bins = bins;
    const double cost = sah_cost(collapse(build_bvh(boxes, config)));
    EXPECT_LT(cost, last) << bins;
    last = cost;
  }
}

TEST(Bvh, StaysBalancedOnALineWhereAreasSayNothing) {
  std::vector<Aabb> boxes;
  for (int i = 0; i < 4096; ++i) boxes.push_back(box_at({float(i), 0, 0}, {0.5f, 0, 0}));
  const Bvh bvh = build_bvh(boxes);
  std::vector<int> depths(bvh.nodes.size(), 0);
  int deepest = 0;
  for (std::size_t i = 0; i < bvh.nodes.size(); ++i) {
    deepest = std::max(deepest, depths[i]);
    if (!bvh.nodes[i].is_leaf())
      depths[bvh.nodes[i].first] = depths[bvh.nodes[i].first + 1] = depths[i] + 1;
  }
  EXPECT_LE(deepest, 14);
}

/// Four items in leaves of one: nodes 1 and 2 are inner, 3 to 6 are leaves.
struct SmallBvh {
  std::vector<Aabb> boxes;
  Bvh bvh;

  SmallBvh() {
    for (int i = 0; i < 4; ++i) boxes.push_back(box_at({float(i) * 10, 0, 0}, {1, 1, 1}));
    bvh = build_bvh(boxes, {.traversal_cost = 0, .max_leaf = 1});
  }
  std::string fault() const { return validate(bvh, boxes, 1); }
};

TEST(BvhCheck, FindsEachKindOfFault) {
  using Break = std::function<void(SmallBvh&)>;
  const std::pair<const char*, Break> faults[] = {
      {"node 0: its box is not that of its content", [](SmallBvh& s) { s.bvh.nodes[0].hi.x += 1; }},
      {"node 3: its box is not that of its content", [](SmallBvh& s) { s.boxes[0].lo.y = -1; }},
      {"node 0: its box is not that of its content",
       [](SmallBvh& s) { s.bvh.nodes[2].hi = s.bvh.nodes[1].hi; }},
      {"node 2: it is not the first to link to node 1",
       [](SmallBvh& s) { s.bvh.nodes[2].first = 1; }},
      {"node 2: it is not the first to link to node 2",
       [](SmallBvh& s) { s.bvh.nodes[2].first = 2; }},
      {"node 2: it links to node 7, which there is not",
       [](SmallBvh& s) { s.bvh.nodes[2].first = 6; }},
      {"node 7: no node before it links to it", [](SmallBvh& s) { s.bvh.nodes.emplace_back(); }},
      {"node 3: a leaf of 2 items", [](SmallBvh& s) { s.bvh.nodes[3].count = 2; }},
      {"node 6: a leaf past the end", [](SmallBvh& s) { s.bvh.nodes[6].first = 4; }},
      {"node 4: it is not the first to link to item 0", [](SmallBvh& s) { s.bvh.refs[1] = 0; }},
      {"node 4: it links to item 9, which there is not", [](SmallBvh& s) { s.bvh.refs[1] = 9; }},
      {"nothing links to item 4", [](SmallBvh& s) { s.boxes.push_back(s.boxes[0]); }},
      {"nothing links to item 0", [](SmallBvh& s) { s.bvh = {}; }},
  };
  ASSERT_EQ(SmallBvh().bvh.nodes.size(), 7u);
  EXPECT_EQ(SmallBvh().fault(), "");
  for (const auto& [fault, break_it] : faults) {
    SmallBvh broken;
    break_it(broken);
    EXPECT_EQ(broken.fault(), fault);
  }
}

TEST(BvhCheck, AllowsTheGreatestDepthAndNoMore) {
  const std::vector<Aabb> boxes(kMaxBvhDepth + 2, box_at({0, 0, 0}, {1, 1, 1}));
  Bvh chain;  // each inner node's second child is the next one
  chain.nodes.push_back(BvhNode::leaf(boxes[0], 0, 1));
  for (std::uint32_t depth = 0; depth <= kMaxBvhDepth; ++depth) {
    EXPECT_EQ(validate(chain, std::span(boxes).first(depth + 1), 1).find("deep"),
              std::string::npos);
    const auto children = static_cast<std::uint32_t>(chain.nodes.size());
    chain.nodes.back() = BvhNode::inner(boxes[0], children);
    chain.nodes.push_back(BvhNode::leaf(boxes[0], depth, 1));
    chain.nodes.push_back(BvhNode::leaf(boxes[0], depth + 1, 1));
    chain.refs.resize(depth + 2);
    std::iota(chain.refs.begin(), chain.refs.end(), 0u);
  }
  EXPECT_NE(validate(chain, boxes, 1).find("too deep"), std::string::npos);
}

}  // namespace
}  // namespace mdk
