#include "preprocess/cli/bench_report.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "preprocess/cli/median.h"

namespace mdk {
namespace {

TechniqueBench made_up_technique() {
  TechniqueBench technique;
  technique.id = "fuzzy-kdtree";
  for (const double ms : {3.0, 1.0, 2.0}) {
    FrameStats stats;
    stats.pose_ms = 0.5;
    stats.update_ms = ms;
    stats.trace_ms = 10 * ms;
    stats.shade_ms = 4;
    technique.frames.push_back({static_cast<std::uint32_t>(technique.frames.size()), stats});
  }
  technique.counters.node_visits = 300;
  technique.counters.triangle_tests = 200;
  technique.counters.clusters_entered = 50;
  technique.rays = 100;
  technique.structure_bytes = 2048;
  technique.prebuild_ms = 7;
  technique.hit_mismatches = 1;
  return technique;
}

std::vector<ModelBench> made_up_models() {
  return {{"a,\"b\".mdk", 12, 3, 2, {made_up_technique()}}};
}

TEST(Median, IsTheMiddleOrTheMeanOfTheTwoInTheMiddle) {
  EXPECT_EQ(median({}), 0);
  EXPECT_EQ(median({3, 1, 2}), 2);
  EXPECT_EQ(median({4, 1, 3, 2}), 2.5);
}

TEST(BenchRun, AFrameKeepsAllPhasesOfItsFastestRound) {
  BenchFrame frame;
  frame.stats.update_ms = 1;
  frame.stats.trace_ms = 9;
  FrameStats faster, slower;
  faster.update_ms = 3;
  faster.trace_ms = 6;
  slower.trace_ms = 11;
  keep_faster(frame, slower);
  EXPECT_EQ(frame.stats.trace_ms, 9);
  keep_faster(frame, faster);
  EXPECT_EQ(frame.stats.update_ms, 3);
  EXPECT_EQ(frame.stats.trace_ms, 6);
}

TEST(BenchReport, JsonHasMediansPerRayFiguresAndFrames) {
  const auto json = nlohmann::json::parse(bench_json({"avx2", 2, 640, 480}, made_up_models()));
  EXPECT_EQ(json["schema"], "mdprep-bench/1");
  EXPECT_EQ(json["isa"], "avx2");
  EXPECT_EQ(json["threads"], 2);
  EXPECT_EQ(json["width"], 640);
  EXPECT_EQ(json["height"], 480);
  const auto& model = json["models"][0];
  EXPECT_EQ(model["triangles"], 12);
  EXPECT_EQ(model["keys"], 3);
  EXPECT_EQ(model["clusters"], 2);
  const auto& row = model["techniques"][0];
  EXPECT_EQ(row["update_ms"], 2.0);
  EXPECT_EQ(row["trace_ms"], 20.0);
  EXPECT_EQ(row["time_to_image_ms"], 26.5);
  EXPECT_DOUBLE_EQ(row["fps"], 1000 / 26.5);
  EXPECT_EQ(row["node_visits_per_ray"], 3.0);
  EXPECT_EQ(row["triangle_tests_per_ray"], 2.0);
  EXPECT_EQ(row["clusters_per_ray"], 0.5);
  EXPECT_EQ(row["structure_bytes"], 2048);
  EXPECT_EQ(row["prebuild_ms"], 7.0);
  EXPECT_EQ(row["hit_mismatches"], 1);
  ASSERT_EQ(row["frames"].size(), 3u);
  EXPECT_EQ(row["frames"][0]["time_to_image_ms"], 37.5);
}

TEST(BenchReport, CsvQuotesWhatItMust) {
  std::istringstream csv(bench_csv({"avx2", 2, 640, 480}, made_up_models()));
  std::string header, row, more;
  std::getline(csv, header);
  std::getline(csv, row);
  EXPECT_FALSE(std::getline(csv, more));
  EXPECT_EQ(header.rfind("file,isa,threads,width,height,triangles,keys,clusters,id,", 0), 0u);
  EXPECT_EQ(row.rfind("\"a,\"\"b\"\".mdk\",avx2,2,640,480,12,3,2,fuzzy-kdtree,0.5,2.0,", 0), 0u);
}

TEST(BenchReport, TableHasARowPerTechnique) {
  std::ostringstream out;
  print_bench_table(out, made_up_models());
  const std::string text = out.str();
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 2);
  EXPECT_NE(text.find("26.50"), std::string::npos);
}

}  // namespace
}  // namespace mdk
