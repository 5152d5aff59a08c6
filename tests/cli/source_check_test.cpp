#include "preprocess/cli/source_check.h"

#include <gtest/gtest.h>

#include "tests/cli/sample_model.h"

namespace mdk {
namespace {

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
