#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "preprocess/bench/results.h"
#include "tests/formats/expect_error.h"
#include "tests/formats/temp_folder.h"
#include "tests/preprocess/bench/made_up_results.h"

namespace mdk::test {
namespace {

TEST(ResultJson, TheFirstRunStandsAtTheTopWithMediansForScripts) {
  const auto json = nlohmann::json::parse(results_json(made_up_results()));
  EXPECT_EQ(json["schema"], "mdprep-bench/1");
  EXPECT_EQ(json["isa"], "avx2");
  EXPECT_EQ(json["threads"], 1);
  EXPECT_EQ(json["width"], 10);
  EXPECT_EQ(json["height"], 10);
  EXPECT_EQ(json["further_runs"][0]["threads"], 2);
  const auto& model = json["models"][0];
  EXPECT_EQ(model["file"], "out/hand.mdk");
  EXPECT_EQ(model["triangles"], 16000);
  EXPECT_EQ(model["keys"], 11);
  EXPECT_EQ(model["clusters"], 4);
  EXPECT_EQ(model["bake"]["stop_reason"], "cost");
  const auto& row = model["techniques"][0];
  EXPECT_EQ(row["update_ms"], 2.0);
  EXPECT_EQ(row["trace_ms"], 20.0);
  EXPECT_EQ(row["time_to_image_ms"], 26.5);
  EXPECT_DOUBLE_EQ(row["fps"], 1000 / 26.5);
  EXPECT_EQ(row["node_visits_per_ray"], 3.0);
  EXPECT_EQ(row["leaf_triangles_per_ray"], 0.4);
  EXPECT_EQ(row["frames"][0]["triangle_setups"], 40);
  EXPECT_EQ(row["triangle_tests_per_ray"], 2.0);
  EXPECT_FALSE(row.contains("kd_cost_ratio")) << "not a kd-tree";
  EXPECT_EQ(model["techniques"][1]["kd_cost_ratio"], 0.25);
  EXPECT_EQ(row["clusters_per_ray"], 0.5);
  EXPECT_EQ(row["structure_bytes"], 2048);
  EXPECT_EQ(row["prebuild_ms"], 7.0);
  EXPECT_EQ(row["hit_mismatches"], 0);
  ASSERT_EQ(row["frames"].size(), 3u);
  EXPECT_EQ(row["frames"][0]["time_to_image_ms"], 37.5);
}

TEST(ResultJson, ReadsBackWhatItWrote) {
  const std::string text = results_json(made_up_results());
  EXPECT_EQ(results_json(parse_results(text, "a.json")), text);
}

TEST(ResultJson, OfOlderProgramsMayLackCountsOfLeavesAndConstants) {
  auto json = nlohmann::json::parse(results_json(made_up_results()));
  for (auto& technique : json["models"][0]["techniques"]) {
    technique.erase("kd_cost_ratio");
    for (auto& frame : technique["frames"]) frame.erase("triangle_setups");
  }
  const BenchResults results = parse_results(json.dump(), "a.json");
  const TechniqueBench& kd = *results.runs[0].models[0].find("fuzzy-kdtree");
  EXPECT_FALSE(kd.has_leaf_counts());
  EXPECT_EQ(kd.kd_cost_ratio, 0);
  EXPECT_EQ(kd.work().triangle_tests, 2.0);
  const auto again = nlohmann::json::parse(results_json(results));
  EXPECT_FALSE(again["models"][0]["techniques"][1].contains("leaf_triangles_per_ray"));
  EXPECT_TRUE(again["models"][1]["techniques"][0].contains("leaf_triangles_per_ray"));
}

TEST(ResultJson, RefusesWhatIsDamagedAndSaysWhere) {
  const auto refused = [](const std::string& from, const std::string& to, const char* words) {
    std::string text = results_json(made_up_results());
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
    expect_error(ErrorCode::kBadInput, words, [&] { parse_results(text, "a.json"); });
  };
  refused("{", "", "a.json: is not JSON");
  refused("mdprep-bench/1", "mdprep-bake/1", "a.json is not of the schema mdprep-bench/1");
  refused("\"isa\"", "\"was\"", "a.json has no isa");
  refused("\"isa\": \"avx2\"", "\"isa\": 5", "a.json: isa is not text");
  refused("\"triangles\": 16000", "\"triangles\": -1", "models 0: triangles is not a whole number");
  refused("\"triangles\": 16000", "\"triangles\": 5000000000", "triangles is too large");
  refused("\"update_ms\":3.0", "\"update_ms\":-3.0", "techniques 0: frames 0: update_ms is not");
  refused("\"models\": [", "\"models\": [], \"others\": [", "a.json has no models");
  expect_error(ErrorCode::kBadInput, "a.json",
               [] { parse_results(std::string(100000, '['), "a.json"); });
}

TEST(BakeFacts, AreReadFromTheReportBesideTheFileIfItIsAboutTheModel) {
  TempFolder folder;
  const std::string mdk = folder.file("hand.mdk");
  EXPECT_FALSE(read_bake_facts(mdk, 12, 3, 2));
  const std::string report =
      R"({"schema":"mdprep-bake/1","triangles":12,"keys":3,"clusters":2,"segments":1,
          "stop_reason":"limit","residual_rms":0.1,"residual_max":0.2,"sah_cost":3,
          "seconds":{"read":1,"decompose":2,"build":3,"write":4,"total":10},
          "peak_memory_bytes":5,"file_bytes":6,
          "growth":[{"clusters":1,"residual_rms":1,"fuzzy_area":8,"sah_cost":9}]})";
  write_text(folder.file("hand.json"), report);
  const std::optional<BakeFacts> facts = read_bake_facts(mdk, 12, 3, 2);
  ASSERT_TRUE(facts);
  EXPECT_EQ(facts->stop_reason, "limit");
  EXPECT_EQ(facts->seconds.total, 10);
  ASSERT_EQ(facts->growth.size(), 1u);
  EXPECT_EQ(facts->growth[0].fuzzy_area, 8);
  EXPECT_FALSE(read_bake_facts(mdk, 13, 3, 2)) << "another model";
  write_text(folder.file("hand.json"), "{}");
  EXPECT_FALSE(read_bake_facts(mdk, 12, 3, 2)) << "not a report";
}

}  // namespace
}  // namespace mdk::test
