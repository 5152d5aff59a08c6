#include "preprocess/commands/checks.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "common/trace/technique.h"
#include "tests/commands/sample_mesh.h"
#include "tests/commands/sample_model.h"

namespace mdk {
namespace {

constexpr std::uint64_t kSeed = 20260726;

/// A sound model with one thing wrong must fail exactly there.
class ModelChecks : public testing::Test {
 protected:
  static void SetUpTestSuite() { sound_ = new ModelStorage(test::sample_model()); }
  static void TearDownTestSuite() {
    delete sound_;
    sound_ = nullptr;
  }

  std::vector<CheckResult> boxes() const {
    const ModelView view = model_.view();
    SilentProgress silent;
    return check_boxes(view, random_moments(view, 100, kSeed), silent);
  }
  std::vector<CheckResult> trees() const {
    SilentProgress silent;
    return {check_trees(model_.view(), silent)};
  }
  static std::vector<std::string> failed(const std::vector<CheckResult>& results) {
    std::vector<std::string> names;
    for (const CheckResult& result : results)
      if (!result.passed()) names.push_back(result.name);
    return names;
  }

  static ModelStorage* sound_;
  ModelStorage model_ = *sound_;
};
ModelStorage* ModelChecks::sound_ = nullptr;

using Names = std::vector<std::string>;

TEST_F(ModelChecks, ASoundModelPassesWithEveryTriangleAtEveryMoment) {
  const std::vector<CheckResult> results = boxes();
  EXPECT_EQ(failed(results), Names{});
  const std::uint64_t triangles = model_.triangles.size();
  ASSERT_EQ(results.size(), 6u);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(results[i].count, triangles * test::kSampleKeys);
  for (int i = 3; i < 6; ++i) EXPECT_EQ(results[i].count, triangles * 100);
  EXPECT_EQ(failed(trees()), Names{});
}

TEST_F(ModelChecks, AShrunkenFuzzyBoxIsSeenAndItsTriangleNamed) {
  model_.fuzzy_boxes[5].hi = model_.fuzzy_boxes[5].lo;
  const std::vector<CheckResult> results = boxes();
  EXPECT_EQ(failed(results), (Names{"fuzzy boxes hold their triangles at keys",
                                    "fuzzy boxes hold their triangles between keys"}));
  EXPECT_EQ(results[0].detail.rfind("first: triangle 5 at key ", 0), 0u) << results[0].detail;
}

TEST_F(ModelChecks, AtAKeyThatTwoSegmentsShareTheBoxesOfBothAreLookedAt) {
  std::uint32_t first = 0;
  while (model_.segments.at(first + 1).first_key != model_.segments[first].last_key) ++first;
  for (const std::uint32_t segment : {first, first + 1}) {
    ModelStorage wrong = model_;
    QuantizedBox& box = wrong.fuzzy_boxes[segment * model_.triangles.size() + 9];
    box.hi = box.lo;
    const ModelView view = wrong.view();
    SilentProgress silent;
    const std::vector<CheckResult> results = check_boxes(view, {}, silent);
    const std::uint32_t keys = view.segments[segment].last_key - view.segments[segment].first_key;
    EXPECT_EQ(results[0].failures, keys + 1u) << "segment " << segment;
  }
}

TEST_F(ModelChecks, AWrongMapIsSeen) {
  model_.local_from_world[model_.clusters.size() * 3].m[0][3] += 0.5f;
  EXPECT_EQ(failed(boxes()), (Names{"fuzzy boxes hold their triangles at keys",
                                    "fuzzy boxes hold their triangles between keys"}));
}

TEST_F(ModelChecks, AShrunkenClusterBoxIsSeen) {
  for (std::size_t key = 0; key < model_.key_times.size(); ++key) {
    QuantizedBox& box = model_.cluster_world_boxes[key * model_.clusters.size() + 1];
    box.lo[1] = static_cast<std::uint16_t>((box.lo[1] + box.hi[1]) / 2);
  }
  EXPECT_EQ(failed(boxes()), (Names{"cluster boxes hold their triangles at keys",
                                    "cluster boxes hold their triangles between keys"}));
}

TEST_F(ModelChecks, ShrunkenBoundsAreSeen) {
  model_.bounds.hi.y -= 0.01f;
  EXPECT_EQ(failed(boxes()),
            (Names{"bounds hold the mesh at keys", "bounds hold the mesh between keys"}));
}

TEST_F(ModelChecks, AShrunkenLocalBoxIsSeenInTheFuzzyBoxesThatLieInIt) {
  model_.fuzzy_trees[1].local_box.lo.x += 0.01f;
  EXPECT_EQ(failed(boxes()), (Names{"fuzzy boxes hold their triangles at keys",
                                    "fuzzy boxes hold their triangles between keys"}));
}

TEST_F(ModelChecks, AReferenceToTheWrongTriangleIsSeenByTreesAndHits) {
  const FuzzyTree& tree = model_.fuzzy_trees[0];
  for (std::uint32_t i = 0; i < tree.ref_count; ++i) {
    std::uint32_t& ref = model_.kd_refs[tree.first_ref + i];
    if (ref == 1) ref = 0;
  }
  EXPECT_EQ(failed(trees()), (Names{"leaves list every triangle that reaches into them"}));
  SilentProgress silent;
  EXPECT_EQ(failed(check_hits(model_.view(), {}, silent)),
            (Names{"fuzzy-kdtree gives brute force's hits"}));
}

TEST_F(ModelChecks, AFlatBoxInASplitPlaneMayStandOnEitherSideButNotOnNone) {
  const auto passes_with = [&](std::vector<std::uint32_t> below, std::vector<std::uint32_t> above) {
    ModelStorage flat = *sound_;
    flat.clusters = {{0, 1}};
    flat.segments.resize(1);
    flat.fuzzy_trees = {{0, 3, 0, static_cast<std::uint32_t>(below.size() + above.size()),
                         Aabb{{-1, -1, -1}, {1, 1, 1}}}};
    flat.fuzzy_trees[0].local_box = {{0, -1, -1}, {2, 1, 1}};
    flat.fuzzy_boxes[0] = {{0, 0, 0}, {0, 65535, 65535}};
    const auto count = static_cast<std::uint32_t>(below.size());
    flat.kd_nodes = {KdNode::inner(0, 0.0f, 1), KdNode::leaf(0, count),
                     KdNode::leaf(count, static_cast<std::uint32_t>(above.size()))};
    flat.kd_refs = below;
    flat.kd_refs.insert(flat.kd_refs.end(), above.begin(), above.end());
    SilentProgress silent;
    return check_trees(flat.view(), silent).passed();
  };
  EXPECT_TRUE(passes_with({0}, {}));
  EXPECT_TRUE(passes_with({}, {0}));
  EXPECT_TRUE(passes_with({0}, {0}));
  EXPECT_FALSE(passes_with({}, {}));
}

TEST_F(ModelChecks, EveryTechniqueAgreesOnASoundModel) {
  const ModelView view = model_.view();
  SilentProgress silent;
  const std::vector<CheckResult> results = check_hits(view, random_moments(view, 2, kSeed), silent);
  EXPECT_EQ(failed(results), Names{});
  const auto is_judged = [](const TechniqueInfo& technique) {
    return technique.kind != TechniqueKind::kOracle && technique.kind != TechniqueKind::kPeer;
  };
  EXPECT_EQ(std::ssize(results), std::ranges::count_if(technique_table(), is_judged));
  for (const CheckResult& result : results) EXPECT_EQ(result.count, 128u * 128 * 3 * (4 + 2));
}

TEST_F(ModelChecks, RandomMomentsVisitEveryIntervalAndNoGapBetweenClips) {
  const ModelView view = model_.view();
  ASSERT_EQ(interval_count(view), 30u + 15u);
  const std::vector<KeyInterval> moments = random_moments(view, 45, kSeed);
  std::vector<int> visits(view.key_count(), 0);
  for (const KeyInterval& at : moments) {
    EXPECT_EQ(at.key1, at.key0 + 1);
    EXPECT_GT(at.s, 0);
    EXPECT_LT(at.s, 1);
    ++visits[at.key0];
  }
  for (std::uint32_t key = 0; key < view.key_count(); ++key)
    EXPECT_EQ(visits[key], key == 30 || key == 46 ? 0 : 1) << key;
}

TEST_F(ModelChecks, RandomMomentsDependOnTheSeedAlone) {
  const ModelView view = model_.view();
  EXPECT_EQ(random_moments(view, 50, 1), random_moments(view, 50, 1));
  EXPECT_NE(random_moments(view, 50, 1), random_moments(view, 50, 2));
}

TEST(SourceCheck, ABakeHasItsSourcesPositionsToTheBit) {
  const ModelStorage model = test::sample_model();
  const PoseSequence source = test::sample_sequence();
  const std::vector<CheckResult> results = check_source(model.view(), source);
  ASSERT_EQ(results.size(), 2u);
  EXPECT_TRUE(results[0].passed()) << results[0].detail;
  EXPECT_TRUE(results[1].passed()) << results[1].detail;
  EXPECT_EQ(results[1].count, 3 * source.triangles.size() * source.key_count());
  EXPECT_EQ(results[1].detail, "largest error 0 of the diagonal");
}

TEST(SourceCheck, OneMovedVertexIsSeen) {
  const ModelStorage model = test::sample_model();
  PoseSequence source = test::sample_sequence();
  source.pose(7)[3].y += 0.25f;
  const std::vector<CheckResult> results = check_source(model.view(), source);
  ASSERT_EQ(results.size(), 2u);
  EXPECT_GT(results[1].failures, 0u);
  EXPECT_LT(results[1].failures, 30u);
}

TEST(SourceCheck, OtherClipsAreSeenBeforePositionsAreCompared) {
  const ModelStorage model = test::sample_model();
  PoseSequence source = test::sample_sequence();
  source.clips[1].name = "another";
  const std::vector<CheckResult> results = check_source(model.view(), source);
  ASSERT_EQ(results.size(), 1u);
  EXPECT_FALSE(results[0].passed());
}

}  // namespace
}  // namespace mdk
