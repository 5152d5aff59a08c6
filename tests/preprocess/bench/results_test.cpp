#include "preprocess/bench/results.h"

#include <gtest/gtest.h>

#include "common/base/error.h"
#include "preprocess/tool/measures.h"
#include "tests/formats/expect_error.h"
#include "tests/preprocess/bench/made_up_results.h"

namespace mdk::test {
namespace {

TEST(Median, IsTheMiddleOrTheMeanOfTheTwoInTheMiddle) {
  EXPECT_EQ(median({}), 0);
  EXPECT_EQ(median({3, 1, 2}), 2);
  EXPECT_EQ(median({4, 1, 3, 2}), 2.5);
}

TEST(Quartiles, LieBetweenNeighboursInOrder) {
  const Quartiles five = quartiles({5, 1, 4, 2, 3});
  EXPECT_EQ(five.low, 2);
  EXPECT_EQ(five.median, 3);
  EXPECT_EQ(five.high, 4);
  const Quartiles two = quartiles({1, 2});
  EXPECT_EQ(two.low, 1.25);
  EXPECT_EQ(two.median, median({1, 2}));
  EXPECT_EQ(quartiles({}).median, 0);
}

TEST(TechniqueBench, MediansAreOverFramesAndWorkIsPerRay) {
  const TechniqueBench technique = made_up_technique("refit-bvh");
  EXPECT_EQ(technique.median_ms(&BenchFrame::update_ms), 2.0);
  EXPECT_EQ(technique.median_ms(&BenchFrame::trace_ms), 20.0);
  EXPECT_EQ(technique.time_to_image_ms().median, 26.5);
  EXPECT_EQ(technique.time_to_image_ms().low, 21.0);
  EXPECT_EQ(technique.work().node_visits, 3.0);
  EXPECT_EQ(technique.work().leaf_triangles, 0.4);
  EXPECT_TRUE(technique.has_leaf_counts());
  EXPECT_EQ(technique.work().triangle_tests, 2.0);
  EXPECT_EQ(technique.work().clusters, 0.5);
}

TEST(TechniqueBench, RoundSpreadIsHowFarTheSecondFastestRoundLiesBehindTheFastest) {
  TechniqueBench technique;
  EXPECT_EQ(technique.round_spread(), 0);
  technique.round_medians_ms = {20};
  EXPECT_EQ(technique.round_spread(), 0);
  technique.round_medians_ms = {90, 22, 20, 50};
  EXPECT_DOUBLE_EQ(technique.round_spread(), 0.1);
}

TEST(BenchFrame, KeepsAllTimesOfItsFastestRound) {
  BenchFrame frame, faster, slower;
  frame.update_ms = 1;
  frame.trace_ms = 9;
  frame.counters.node_visits = 7;
  faster.update_ms = 3;
  faster.trace_ms = 6;
  slower.trace_ms = 11;
  keep_faster(frame, slower);
  EXPECT_EQ(frame.trace_ms, 9);
  keep_faster(frame, faster);
  EXPECT_EQ(frame.update_ms, 3);
  EXPECT_EQ(frame.trace_ms, 6);
  EXPECT_EQ(frame.counters.node_visits, 7u);
}

TEST(MergeResults, PutsOtherModelsTechniquesAndSettingsSideBySide) {
  const BenchResults whole = made_up_results();
  BenchResults parts[3] = {whole, whole, whole};
  parts[0].runs.resize(1);
  parts[0].runs[0].models.resize(1);
  const TechniqueBench last = parts[0].runs[0].models[0].techniques.back();
  parts[0].runs[0].models[0].techniques.pop_back();
  parts[1].runs.erase(parts[1].runs.begin());
  parts[2].runs.resize(1);
  parts[2].runs[0].models[0].techniques = {last};

  BenchResults merged;
  for (const BenchResults& part : parts) merge_results(merged, part, "a.json");
  ASSERT_EQ(merged.runs.size(), 2u);
  ASSERT_EQ(merged.runs[0].models.size(), 2u);
  EXPECT_EQ(merged.runs[0].models[0].techniques.size(), whole.runs[0].models[0].techniques.size());
  EXPECT_EQ(merged.runs[0].models[0].techniques.back().id, "embree");
  EXPECT_EQ(merged.runs[0].models[0].techniques.back().round_medians_ms.size(), 2u);
  EXPECT_EQ(merged.runs[1].setting.threads, 2);
}

TEST(MergeResults, TakesTheSameAgainForFurtherRounds) {
  BenchResults merged = made_up_results(), again = made_up_results();
  again.runs[0].models[0].techniques[0] = made_up_technique("fuzzy-bvh", 0.5);
  again.runs[0].models[0].techniques[1] = made_up_technique("fuzzy-kdtree", 9);
  merge_results(merged, again, "b.json");
  const ModelBench& hand = merged.runs[0].models[0];
  EXPECT_EQ(hand.techniques[0].time_to_image_ms().median, 26.5 / 2);
  EXPECT_EQ(hand.techniques[1].time_to_image_ms().median, 26.5 * 1.5);
  EXPECT_EQ(hand.techniques[0].round_medians_ms.size(), 4u);
}

TEST(MergeResults, RefusesWhatCannotBelongTogether) {
  const auto refused = [](auto change) {
    BenchResults merged = made_up_results(), other = made_up_results();
    change(other);
    expect_error(ErrorCode::kBadInput, "b.json", [&] { merge_results(merged, other, "b.json"); });
  };
  refused([](BenchResults& r) { r.machine.cpu = "another"; });
  refused([](BenchResults& r) { r.program.commit = "another"; });
  refused([](BenchResults& r) { r.runs[0].models[0].triangles = 3; });
  refused([](BenchResults& r) { r.runs[0].models[0].techniques[0].frames.pop_back(); });
  refused([](BenchResults& r) { r.runs[0].models[0].techniques[0].frames[1].key = 4; });
}

}  // namespace
}  // namespace mdk::test
