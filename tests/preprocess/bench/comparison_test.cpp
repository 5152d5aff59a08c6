#include "preprocess/bench/comparison.h"

#include <gmock/gmock.h>

#include <sstream>

#include "tests/formats/expect_error.h"
#include "tests/preprocess/bench/made_up_results.h"

namespace mdk::test {
namespace {

BenchResults one_technique(const TechniqueBench& technique) {
  BenchResults results = made_up_results();
  results.runs.resize(1);
  results.runs[0].models.resize(1);
  results.runs[0].models[0].techniques = {technique};
  return results;
}

/// One compared with itself, all times `factor`.
ComparedTechnique compared(double factor) {
  const auto rows = compare_results(one_technique(made_up_technique("fuzzy-bvh")),
                                    one_technique(made_up_technique("fuzzy-bvh", factor)));
  EXPECT_EQ(rows.size(), 1u);
  return rows.front();
}

TEST(Comparison, WhatLiesWithinTheSpreadIsTheSame) {
  EXPECT_EQ(compared(1).verdict, Verdict::kSame);
  EXPECT_EQ(compared(1.03).verdict, Verdict::kSame) << "rounds lay 4 % apart";
  EXPECT_EQ(compared(0.97).verdict, Verdict::kSame);
  EXPECT_EQ(compared(1.10).verdict, Verdict::kSlower);
  EXPECT_EQ(compared(0.90).verdict, Verdict::kFaster);
}

TEST(Comparison, TheAnimationsOwnUpsAndDownsCancel) {
  const ComparedTechnique row = compared(2);
  EXPECT_DOUBLE_EQ(row.ratio.median, 2);
  EXPECT_GT(row.ratio.low, 1.9) << "though frames differ by a factor of 2.4";
  EXPECT_LT(row.ratio.high, 2.1);
}

TEST(Comparison, FramesThatDisagreeWidenTheSpread) {
  TechniqueBench uneven = made_up_technique("fuzzy-bvh");
  uneven.frames[0].trace_ms *= 1.5;
  uneven.frames[1].trace_ms *= 0.5;
  uneven.frames[2].trace_ms *= 1.1;
  const auto rows =
      compare_results(one_technique(made_up_technique("fuzzy-bvh")), one_technique(uneven));
  EXPECT_EQ(rows.front().verdict, Verdict::kSame);
}

TEST(Comparison, QuietRoundsLetSmallDifferencesBeSeen) {
  TechniqueBench before = made_up_technique("fuzzy-bvh"),
                 after = made_up_technique("fuzzy-bvh", 1.03);
  before.round_medians_ms = {26.5, 26.5};
  after.round_medians_ms = {27.3, 27.3};
  EXPECT_EQ(compare_results(one_technique(before), one_technique(after)).front().verdict,
            Verdict::kSlower);
}

TEST(Comparison, CountsAreComparedExactly) {
  TechniqueBench more_tests = made_up_technique("fuzzy-bvh");
  more_tests.frames[0].counters.triangle_tests += 60;
  const auto rows =
      compare_results(one_technique(made_up_technique("fuzzy-bvh")), one_technique(more_tests));
  EXPECT_EQ(rows.front().visits_ratio, 1);
  EXPECT_DOUBLE_EQ(rows.front().tests_ratio, 1.1);
}

TEST(Comparison, TakesWhatBothHaveAndRefusesWhereThatIsNothing) {
  const BenchResults whole = made_up_results();
  EXPECT_EQ(compare_results(whole, whole).size(), 7u + 3u + 2u);
  BenchResults other = whole;
  for (BenchRun& run : other.runs) run.setting.isa = "sse4";
  expect_error(ErrorCode::kBadInput, "in common", [&] { compare_results(whole, other); });
}

TEST(Comparison, IsPrintedWithATally) {
  std::ostringstream out;
  print_comparison(out, {compared(1), compared(1.5), compared(0.5)});
  EXPECT_THAT(out.str(), testing::HasSubstr("avx2, 1 thread, 10x10, diffuse\n"));
  EXPECT_THAT(out.str(), testing::EndsWith("\n1 faster, 1 the same, 1 slower\n"));
}

}  // namespace
}  // namespace mdk::test
