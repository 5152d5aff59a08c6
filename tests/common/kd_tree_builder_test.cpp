// The kd-tree builder: boxes are covered by the leaves that list them, splits are the cheapest
// there are, and size and depth stay within bounds on every kind of scene.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "common/structures/kd_tree.h"
#include "tests/common/random_boxes.h"

namespace mdk {
namespace {

using test::box_at;
using test::Random;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// Depth of the deepest leaf under a node.
std::uint32_t depth_of(const KdTree& tree, std::uint32_t index = 0) {
  const KdNode& node = tree.nodes[index];
  if (node.is_leaf()) return 0;
  return 1 + std::max(depth_of(tree, node.below()), depth_of(tree, node.above()));
}

TEST(KdTreeBuilder, MakesOneEmptyLeafOfNothing) {
  for (const std::vector<Aabb>& boxes : {std::vector<Aabb>{}, std::vector<Aabb>(3)}) {
    const KdTree tree = build_kd_tree(boxes);
    ASSERT_EQ(tree.nodes.size(), 1u);
    EXPECT_TRUE(tree.nodes[0].is_leaf());
    EXPECT_EQ(tree.nodes[0].ref_count(), 0u);
    EXPECT_THAT(tree.refs, IsEmpty());
    EXPECT_TRUE(tree.bounds.empty());
    EXPECT_EQ(sah_cost(tree.view(), {}), 0);
  }
}

TEST(KdTreeBuilder, LeavesEmptyBoxesOutAndAddsTheBaseToReferences) {
  const std::vector<Aabb> boxes{Aabb{}, box_at({0, 0, 0}, {1, 1, 1}), Aabb{},
                                box_at({9, 0, 0}, {1, 1, 1})};
  KdTree tree = build_kd_tree(boxes, 1000);
  EXPECT_EQ(validate(tree.view(), boxes, 1000), "");
  std::sort(tree.refs.begin(), tree.refs.end());
  EXPECT_THAT(tree.refs, ElementsAre(1001, 1003));
}

TEST(KdTreeBuilder, CutsTwoPilesApartByEmptySpace) {
  // Ten unit cubes in one place and ten far along x: cutting either pile off at its face is best.
  std::vector<Aabb> boxes(10, box_at({0, 0, 0}, {1, 1, 1}));
  boxes.resize(20, box_at({9, 0, 0}, {1, 1, 1}));
  const KdTree tree = build_kd_tree(boxes);
  ASSERT_FALSE(tree.nodes[0].is_leaf());
  EXPECT_EQ(tree.nodes[0].axis(), 0u);
  EXPECT_EQ(tree.nodes[0].split(), 1.0f);
  // Below: the first pile. Above: empty space up to 9, then the second pile.
  EXPECT_TRUE(tree.nodes[1].is_leaf());
  EXPECT_EQ(tree.nodes[1].ref_count(), 10u);
  EXPECT_EQ(tree.nodes[2].split(), 9.0f);
  EXPECT_EQ(tree.nodes[tree.nodes[2].below()].ref_count(), 0u);
  EXPECT_EQ(tree.nodes[tree.nodes[2].above()].ref_count(), 10u);
  EXPECT_EQ(tree.refs.size(), 20u);
}

TEST(KdTreeBuilder, PutsItemsThatLieInThePlaneOnTheSideWhereTheyCostLess) {
  // Twenty sheets in the plane x = 1, a pile in the thin part before it, empty space behind: the
  // sheets belong to the thin part, not to the large one.
  std::vector<Aabb> boxes(20, Aabb{{1, 0, 0}, {1, 1, 1}});
  boxes.push_back(box_at({0, 0, 0}, {1, 1, 1}));
  boxes.push_back(box_at({8, 0, 0}, {1, 1, 1}));
  KdBuildConfig config;
  config.max_depth = 1;
  const KdTree before = build_kd_tree(boxes, 0, config);
  ASSERT_EQ(before.nodes.size(), 3u);
  EXPECT_EQ(before.nodes[0].split(), 1.0f);
  EXPECT_EQ(before.nodes[1].ref_count(), 21u);
  EXPECT_EQ(before.nodes[2].ref_count(), 1u);
  // The mirror image decides the other way.
  for (Aabb& box : boxes) box = {{-box.hi.x, 0, 0}, {-box.lo.x, 1, 1}};
  const KdTree behind = build_kd_tree(boxes, 0, config);
  EXPECT_EQ(behind.nodes[0].split(), -1.0f);
  EXPECT_EQ(behind.nodes[1].ref_count(), 1u);
  EXPECT_EQ(behind.nodes[2].ref_count(), 21u);
}

/// The cheapest single split by the book: every box face as a plane, every item counted anew.
double cheapest_by_force(const std::vector<Aabb>& boxes, const KdBuildConfig& config) {
  Aabb bounds;
  for (const Aabb& box : boxes) bounds.extend(box);
  const auto area = [&](const Aabb& b) {
    return config.area.area(to_double(b.hi) - to_double(b.lo));
  };
  double best = static_cast<double>(config.intersect_cost) * boxes.size();
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const Aabb& face : boxes)
      for (const float plane : {face.lo[axis], face.hi[axis]}) {
        if (plane <= bounds.lo[axis] || plane >= bounds.hi[axis]) continue;
        Aabb below = bounds, above = bounds;
        below.hi[axis] = above.lo[axis] = plane;
        int below_count = 0, above_count = 0, planar = 0;
        for (const Aabb& box : boxes) {
          if (box.lo[axis] == plane && box.hi[axis] == plane) ++planar;
          below_count += box.lo[axis] < plane;
          above_count += box.hi[axis] > plane;
        }
        for (const int to_below : {0, planar})
          best = std::min(
              best, config.traversal_cost + config.intersect_cost *
                                                (area(below) * (below_count + to_below) +
                                                 area(above) * (above_count + planar - to_below)) /
                                                area(bounds));
      }
  return best;
}

TEST(KdTreeBuilder, TakesTheCheapestOfAllPlanes) {
  const std::uint64_t seed = 43;
  Random random(seed);
  for (int round = 0; round < 300; ++round) {
    std::vector<Aabb> boxes;
    const std::size_t count = 2 + random.below(12);
    for (std::size_t i = 0; i < count; ++i) {
      const auto size = [&] { return random.below(3) == 0 ? 0.0f : random.between(0, 0.4f); };
      boxes.push_back(box_at(random.point({{0, 0, 0}, {1, 2, 3}}), {size(), size(), size()}));
    }
    KdBuildConfig config;
    config.max_depth = 1;
    config.empty_bonus = 1;
    config.area = {random.unit() + 0.01, random.unit() + 0.01, random.unit() + 0.01};
    const double cost = sah_cost(build_kd_tree(boxes, 0, config).view(), config);
    ASSERT_NEAR(cost, cheapest_by_force(boxes, config), 1e-9 * cost)
        << "seed " << seed << " round " << round;
  }
}

TEST(KdTreeBuilder, FollowsTheWeightsOfTheAxes) {
  // A 4 x 4 x 1 sheet of cubes: where areas across x hardly count, cutting x gains nothing.
  std::vector<Aabb> boxes;
  for (int i = 0; i < 16; ++i) boxes.push_back(box_at({float(i % 4), float(i / 4), 0}, {1, 1, 1}));
  KdBuildConfig config;
  config.area = {1e-6, 1, 1e-6};  // only faces across x count: x slices keep their whole area
  const KdTree along_y = build_kd_tree(boxes, 0, config);
  EXPECT_EQ(along_y.nodes[0].axis(), 1u);
  config.area = {1e-6, 1e-6, 1};
  const KdTree along_x = build_kd_tree(boxes, 0, config);
  EXPECT_EQ(along_x.nodes[0].axis(), 0u);
}

TEST(KdTreeBuilder, CutsOffEmptySpaceOnlyWhereTheBonusMakesItPay) {
  // The two piles again: the root's split gains much, cutting the gap off gains just less than an
  // expensive step costs.
  std::vector<Aabb> boxes(10, box_at({0, 0, 0}, {1, 1, 1}));
  boxes.resize(20, box_at({9, 0, 0}, {1, 1, 1}));
  KdBuildConfig config;
  config.traversal_cost = 13;
  config.empty_bonus = 1;
  EXPECT_EQ(build_kd_tree(boxes, 0, config).nodes.size(), 3u);
  config.empty_bonus = 0.9f;
  EXPECT_EQ(build_kd_tree(boxes, 0, config).nodes.size(), 5u);
}

TEST(KdTreeBuilder, StopsAtTheDepthAskedFor) {
  const std::vector<Aabb> boxes = test::scattered_boxes(2000, 1, 0.02f, 44);
  for (const std::uint32_t depth : {1u, 2u, 5u, 9u}) {
    KdBuildConfig config;
    config.max_depth = depth;
    EXPECT_EQ(depth_of(build_kd_tree(boxes, 0, config)), depth);
  }
}

TEST(KdTreeBuilder, NeverPassesTheDepthThatTraversalStacksHold) {
  // Along the diagonal, each box at twice the distance of the last: the heuristic peels off one
  // after the other.
  std::vector<Aabb> boxes;
  for (int e = -120; e < 120; ++e) {
    const float x = std::ldexp(1.0f, e), size = x * 0.01f;
    boxes.push_back(box_at({x, x, x}, {size, size, size}));
  }
  KdBuildConfig config;
  config.max_depth = 100000;
  const KdTree tree = build_kd_tree(boxes, 0, config);
  EXPECT_EQ(validate(tree.view(), boxes), "");
  EXPECT_EQ(depth_of(tree), kMaxKdDepth);
}

TEST(KdTreeBuilder, KeepsIdenticalBoxesInOneLeaf) {
  const KdTree tree = build_kd_tree(std::vector<Aabb>(1000, box_at({1, 1, 1}, {1, 2, 3})));
  EXPECT_EQ(tree.nodes.size(), 1u);
  EXPECT_EQ(tree.refs.size(), 1000u);
}

TEST(KdTreeBuilder, BoundsReferencesHoweverMuchBoxesOverlap) {
  const std::vector<Aabb> boxes = test::scattered_boxes(3000, 1, 1.5f, 45);
  KdBuildConfig config;
  config.max_depth = kMaxKdDepth;
  config.traversal_cost = 1e-6f;  // any gain at all is taken: copies would multiply
  const KdTree tree = build_kd_tree(boxes, 0, config);
  EXPECT_EQ(validate(tree.view(), boxes), "");
  EXPECT_LE(tree.refs.size(), 8u * 3000u);
  EXPECT_GT(tree.refs.size(), 4u * 3000u);
}

TEST(KdTreeBuilder, LaysNodesOutDepthFirstWithChildrenSideBySide) {
  const KdTree tree = build_kd_tree(test::scattered_boxes(500, 1, 0.05f, 46));
  // In depth-first order each pair of children is the first that no earlier node has taken.
  std::uint32_t next = 1;
  std::vector<std::uint32_t> pending{0};
  std::uint32_t next_ref = 0;
  while (!pending.empty()) {
    const KdNode& node = tree.nodes[pending.back()];
    pending.pop_back();
    if (node.is_leaf()) {
      ASSERT_EQ(node.first_ref(), next_ref);
      next_ref += node.ref_count();
      continue;
    }
    ASSERT_EQ(node.below(), next);
    next += 2;
    pending.push_back(node.above());
    pending.push_back(node.below());
  }
  EXPECT_EQ(next, tree.nodes.size());
  EXPECT_EQ(next_ref, tree.refs.size());
}

/// References under each node, summed over all nodes: how many events the build passes over, but
/// for a constant factor.
std::size_t work_of(const KdTree& tree) {
  std::vector<std::size_t> under(tree.nodes.size());
  std::size_t work = 0;
  for (std::size_t i = tree.nodes.size(); i-- > 0;) {
    const KdNode& node = tree.nodes[i];
    under[i] = node.is_leaf() ? node.ref_count() : under[node.below()] + under[node.above()];
    work += under[i];
  }
  return work;
}

TEST(KdTreeBuilder, TakesWorkInProportionToNLogN) {
  std::vector<double> per_n_log_n;
  for (const std::size_t n : {1000u, 8000u, 64000u}) {
    // The same density at every size.
    const auto side = static_cast<float>(std::cbrt(static_cast<double>(n)));
    const KdTree tree = build_kd_tree(test::scattered_boxes(n, side, 0.7f, 47));
    per_n_log_n.push_back(static_cast<double>(work_of(tree)) /
                          (static_cast<double>(n) * std::log2(static_cast<double>(n))));
    RecordProperty("work_per_n_log_n_" + std::to_string(n), std::to_string(per_n_log_n.back()));
  }
  for (const double w : per_n_log_n) EXPECT_LT(w, 4);
  EXPECT_LT(per_n_log_n.back(), 1.25 * per_n_log_n.front());
}

TEST(KdTreeCost, IsThatOfTheFormulaOnAHandMadeTree) {
  KdTree tree;
  tree.bounds = {{0, 0, 0}, {4, 1, 1}};  // area 18
  tree.nodes = {KdNode::inner(0, 1.0f, 1), KdNode::leaf(0, 2), KdNode::leaf(2, 1)};
  tree.refs = {0, 1, 2};
  KdBuildConfig config;
  config.traversal_cost = 3;
  config.intersect_cost = 5;
  // Below: a unit cube, area 6, two items. Above: 3 x 1 x 1, area 14, one item.
  EXPECT_NEAR(sah_cost(tree.view(), config), 3 + 5 * (6 * 2 + 14 * 1) / 18.0, 1e-12);
  // Weighted: root 2 (4 xy + yz + 4 zx) = 74, below 2 (2 + 3 + 5)... as AreaWeights says.
  config.area = {2, 3, 5};
  const double root = 2 * (2 * 4 + 3 * 1 + 5 * 4), below = 2 * (2 + 3 + 5),
               above = 2 * (2 * 3 + 3 + 5 * 3);
  EXPECT_NEAR(sah_cost(tree.view(), config), 3 + 5 * (below * 2 + above) / root, 1e-12);
}

TEST(KdTreeCost, CountsByLengthWhereAllBoxesLieOnALine) {
  KdTree tree;
  tree.bounds = {{0, 0, 0}, {4, 0, 0}};
  tree.nodes = {KdNode::inner(0, 1.0f, 1), KdNode::leaf(0, 2), KdNode::leaf(2, 1)};
  tree.refs = {0, 1, 2};
  EXPECT_NEAR(sah_cost(tree.view(), {}), 1 + 1.5 * (0.25 * 2 + 0.75), 1e-12);
}

}  // namespace
}  // namespace mdk
