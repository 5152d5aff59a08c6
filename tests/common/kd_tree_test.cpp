// The check of kd-trees: what it accepts can be walked blindly, and what cannot be is refused; with
// the boxes at hand it finds every box that is missing somewhere.
#include "common/structures/kd_tree.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/common/random_boxes.h"

namespace mdk {
namespace {

/// Walks as the tracer does: no checks but those of at(), which throws outside. Returns how many
/// references it passed.
std::size_t walk(const std::vector<KdNode>& nodes, const std::vector<std::uint32_t>& refs,
                 std::uint32_t ref_limit) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> stack{{0, 0}};
  std::size_t passed = 0, steps = 0;
  while (!stack.empty()) {
    const auto [index, depth] = stack.back();
    stack.pop_back();
    if (++steps > nodes.size()) throw std::runtime_error("a node was reached twice");
    if (depth > kMaxKdDepth) throw std::runtime_error("too deep for the traversal stack");
    const KdNode& node = nodes.at(index);
    if (node.is_leaf()) {
      for (std::uint32_t r = 0; r < node.ref_count(); ++r)
        if (refs.at(std::size_t{node.first_ref()} + r) >= ref_limit)
          throw std::runtime_error("a reference to nothing");
      passed += node.ref_count();
    } else {
      stack.push_back({node.above(), depth + 1});
      stack.push_back({node.below(), depth + 1});
    }
  }
  return passed;
}

/// Root split, one leaf below, a second split above with a leaf on each side.
KdTree small_tree() {
  KdTree tree;
  tree.nodes = {KdNode::inner(0, 0.5f, 1), KdNode::leaf(0, 2), KdNode::inner(2, 0.25f, 3),
                KdNode::leaf(2, 1), KdNode::leaf(3, 0)};
  tree.refs = {10, 11, 12};
  tree.bounds = {{0, 0, 0}, {1, 1, 1}};
  return tree;
}

bool is_sound(const KdTreeView& tree, std::uint32_t ref_begin, std::uint32_t ref_end) {
  return validate(tree, ref_begin, ref_end).empty();
}

bool accepted(const KdTree& tree) { return is_sound(tree.view(), 10, 13); }

TEST(KdTreeCheck, AcceptsASmallTree) { EXPECT_TRUE(accepted(small_tree())); }

TEST(KdTreeCheck, AcceptsASingleEmptyLeaf) {
  KdTree tree;
  tree.nodes = {KdNode::leaf(0, 0)};
  EXPECT_TRUE(is_sound(tree.view(), 0, 0));
}

TEST(KdTreeCheck, RefusesATreeWithoutNodes) { EXPECT_FALSE(is_sound(KdTreeView{}, 0, 0)); }

TEST(KdTreeCheck, RefusesALinkToItselfOrBackward) {
  KdTree tree = small_tree();
  tree.nodes[2] = KdNode::inner(2, 0.25f, 2);
  EXPECT_FALSE(accepted(tree));
  tree.nodes[2] = KdNode::inner(2, 0.25f, 0);
  EXPECT_FALSE(accepted(tree));
}

TEST(KdTreeCheck, RefusesAChildPastTheEnd) {
  KdTree tree = small_tree();
  tree.nodes[2] = KdNode::inner(2, 0.25f, 4);
  EXPECT_FALSE(accepted(tree));
  tree.nodes[2] = KdNode::inner(2, 0.25f, (1u << 30) - 1);
  EXPECT_FALSE(accepted(tree));
}

TEST(KdTreeCheck, RefusesANodeWithTwoParents) {
  KdTree tree = small_tree();
  tree.nodes[1] = KdNode::inner(1, 0.5f, 3);
  EXPECT_FALSE(accepted(tree));
}

TEST(KdTreeCheck, RefusesANodeThatNothingLinksTo) {
  KdTree tree = small_tree();
  tree.nodes.push_back(KdNode::leaf(0, 0));
  EXPECT_FALSE(accepted(tree));
}

TEST(KdTreeCheck, RefusesRunsOutsideTheReferences) {
  KdTree tree = small_tree();
  tree.nodes[4] = KdNode::leaf(3, 1);
  EXPECT_FALSE(accepted(tree));
  tree.nodes[4] = KdNode::leaf(4, 0);
  EXPECT_FALSE(accepted(tree));
  tree.nodes[4] = KdNode::leaf(3, 0);
  tree.nodes[3] = KdNode::leaf(0xffffffffu, 1);  // the sum wraps to 0 in 32 bits
  EXPECT_FALSE(accepted(tree));
}

TEST(KdTreeCheck, RefusesOverlappingRunsThatAddUpToMoreThanThereIs) {
  KdTree tree = small_tree();
  tree.nodes[4] = KdNode::leaf(0, 1);
  EXPECT_FALSE(accepted(tree));
}

TEST(KdTreeCheck, RefusesReferencesOutsideTheirRange) {
  for (const std::uint32_t wrong : {0u, 9u, 13u, 0xffffffffu}) {
    KdTree tree = small_tree();
    tree.refs[1] = wrong;
    EXPECT_FALSE(accepted(tree)) << wrong;
  }
}

TEST(KdTreeCheck, RefusesSplitsThatAreNotFinite) {
  for (const float wrong :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
        -std::numeric_limits<float>::infinity()}) {
    KdTree tree = small_tree();
    tree.nodes[0] = KdNode::inner(0, wrong, 1);
    EXPECT_FALSE(accepted(tree)) << wrong;
  }
}

/// A chain: each inner node's second child is the next inner node, the last one's a leaf.
KdTree chain(std::uint32_t depth) {
  KdTree tree;
  tree.nodes.push_back(KdNode::leaf(0, 0));
  for (std::uint32_t d = 0; d < depth; ++d) {
    const auto children = static_cast<std::uint32_t>(tree.nodes.size());
    tree.nodes.back() = KdNode::inner(0, 0.5f, children);
    tree.nodes.resize(children + 2u, KdNode::leaf(0, 0));
  }
  return tree;
}

TEST(KdTreeCheck, AcceptsTheGreatestDepthAndNoMore) {
  EXPECT_TRUE(is_sound(chain(kMaxKdDepth).view(), 0, 0));
  EXPECT_FALSE(is_sound(chain(kMaxKdDepth + 1).view(), 0, 0));
  EXPECT_FALSE(is_sound(chain(1000).view(), 0, 0));
}

TEST(KdTreeCheck, SaysWhatIsWrong) {
  KdTree tree = small_tree();
  tree.nodes[1] = KdNode::inner(1, 0.5f, 3);
  EXPECT_EQ(validate(tree.view(), 10, 13), "node 2: it is not the first to link to node 3");
  tree.nodes.pop_back();
  EXPECT_EQ(validate(tree.view(), 10, 13), "node 1: it links to node 4, which there is not");
}

/// A tree over boxes 10 to 12 that small_tree() is right for: 10 across the first split, 11 flat in
/// it, 12 above.
std::vector<Aabb> boxes_of_small_tree() {
  return {{{0, 0, 0}, {0.5f, 1, 1}}, {{0.5f, 0, 0}, {0.5f, 1, 1}}, {{0.75f, 0, 0}, {1, 1, 0.25f}}};
}

TEST(KdTreeCheck, FindsABoxThatIsMissingSomewhereOrListedElsewhere) {
  const auto fault_with = [](const auto& change) {
    KdTree tree = small_tree();
    std::vector<Aabb> boxes = boxes_of_small_tree();
    change(tree, boxes);
    return validate(tree.view(), boxes, 10);
  };
  using Boxes = std::vector<Aabb>;
  EXPECT_EQ(fault_with([](KdTree&, Boxes&) {}), "");
  EXPECT_EQ(fault_with([](KdTree& t, Boxes&) { t.bounds.hi.x = 2; }),
            "the bounds are not the union of the boxes");
  EXPECT_EQ(fault_with([](KdTree&, Boxes& b) { b[0].hi.x = 0.75f; }),
            "box 0 is not listed everywhere it is");
  EXPECT_EQ(fault_with([](KdTree&, Boxes& b) { b[2].hi.z = 0.5f; }),
            "box 2 is not listed everywhere it is");
  EXPECT_EQ(fault_with([](KdTree& t, Boxes&) { t.refs[1] = 10; }),
            "node 1: a leaf lists a box twice");
  EXPECT_EQ(fault_with([](KdTree& t, Boxes&) { t.refs[1] = 12; }),
            "node 1: box 2 does not touch the cell");
  EXPECT_EQ(fault_with([](KdTree& t, Boxes&) { t.nodes[0] = KdNode::inner(0, 0, 1); }),
            "node 0: the split is not inside the cell");
  EXPECT_EQ(fault_with([](KdTree& t, Boxes&) { t.nodes[1] = KdNode::leaf(0, 1); }),
            "box 1 is not listed everywhere it is");
}

TEST(KdTreeCheck, FindsEveryReferenceThatIsTakenOutOfABuiltTree) {
  const std::vector<Aabb> boxes = test::scattered_boxes(60, 1, 0.3f, 33);
  const KdTree built = build_kd_tree(boxes);
  ASSERT_EQ(validate(built.view(), boxes), "");
  ASSERT_GT(built.refs.size(), boxes.size());
  for (KdNode node : built.nodes)
    for (std::uint32_t r = 0; node.is_leaf() && r < node.ref_count(); ++r) {
      KdTree tree = built;
      const std::uint32_t last = node.first_ref() + node.ref_count() - 1;
      std::swap(tree.refs[node.first_ref() + r], tree.refs[last]);
      for (KdNode& n : tree.nodes)
        if (n.is_leaf() && n.first_ref() == node.first_ref() && n.ref_count() == node.ref_count())
          n = KdNode::leaf(node.first_ref(), node.ref_count() - 1);
      EXPECT_NE(validate(tree.view(), boxes), "") << "leaf at " << node.first_ref() << ", " << r;
    }
}

TEST(KdTreeCheck, AnyFlippedBitIsRefusedOrHarmless) {
  const KdTree built = build_kd_tree(test::scattered_boxes(40, 1, 0.1f, 31));
  ASSERT_TRUE(is_sound(built.view(), 0, 40));
  ASSERT_GT(built.nodes.size(), 20u);
  int refused = 0, harmless = 0;
  const auto judge = [&](const KdTree& tree) {
    if (!is_sound(tree.view(), 0, 40)) {
      ++refused;
      return;
    }
    ++harmless;
    std::size_t passed = 0;
    ASSERT_NO_THROW(passed = walk(tree.nodes, tree.refs, 40));
    ASSERT_LE(passed, tree.refs.size());
  };
  for (std::size_t i = 0; i < built.nodes.size(); ++i)
    for (std::uint32_t bit = 0; bit < 64; ++bit) {
      KdTree tree = built;
      (bit < 32 ? tree.nodes[i].word0 : tree.nodes[i].word1) ^= 1u << (bit % 32);
      judge(tree);
    }
  for (std::size_t i = 0; i < built.refs.size(); ++i)
    for (std::uint32_t bit = 0; bit < 32; ++bit) {
      KdTree tree = built;
      tree.refs[i] ^= 1u << bit;
      judge(tree);
    }
  // Neither side is empty: links and runs are caught, bits of a split's mantissa are not wrong.
  EXPECT_GT(refused, 1000);
  EXPECT_GT(harmless, 100);
}

TEST(KdTreeCheck, RandomNodesAreRefusedOrHarmless) {
  const std::uint64_t seed = 32;
  test::Random random(seed);
  int accepted_count = 0;
  for (int round = 0; round < 20000; ++round) {
    std::vector<KdNode> nodes(1 + random.below(7));
    std::vector<std::uint32_t> refs(random.below(4));
    for (KdNode& node : nodes)
      node = random.below(2) == 0 ? KdNode::leaf(static_cast<std::uint32_t>(random.below(4)),
                                                 static_cast<std::uint32_t>(random.below(3)))
                                  : KdNode::inner(static_cast<std::uint32_t>(random.below(3)), 1.0f,
                                                  static_cast<std::uint32_t>(random.below(8)));
    if (!is_sound({nodes, refs, {}}, 0, 1)) continue;
    ++accepted_count;
    ASSERT_NO_THROW(walk(nodes, refs, 1)) << "seed " << seed << " round " << round;
  }
  EXPECT_GT(accepted_count, 100);
}

}  // namespace
}  // namespace mdk
