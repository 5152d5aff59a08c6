// mdprep bench, started as a user does. No times are judged.
#include <gmock/gmock.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "common/structures/kd_tree.h"
#include "common/trace/technique.h"
#include "formats/mdk/writer.h"
#include "tests/commands/baked_sample.h"
#include "tests/commands/program_run.h"
#include "tests/commands/sample_mesh.h"
#include "tests/commands/sample_model.h"

namespace mdk::test {
namespace {

using Json = nlohmann::ordered_json;

std::vector<std::string> names_of(const Json& object) {
  std::vector<std::string> names;
  for (const auto& [name, value] : object.items()) names.push_back(name);
  return names;
}

class Bench : public BakedSample {
 protected:
  Outcome bench(std::vector<std::string> options) const {
    options.insert(options.begin(), {"bench", baked(), "--size", "64x48", "--rounds", "2"});
    return run_mdprep(options);
  }
};

TEST_F(Bench, TheCostPredictedOfAFileIsTheOneItsBakeReported) {
  const std::string file = folder_.file("again.mdk");
  ASSERT_EQ(run_mdprep({"bake", source(), "-o", file, "-q", "--segments", "3", "--report",
                        folder_.file("report.json")})
                .status,
            0);
  ASSERT_EQ(run_mdprep({"bench", file, "--techniques", "fuzzy-bvh", "--size", "64x64", "--frames",
                        "1", "--rounds", "1", "-q", "--json", folder_.file("b.json")})
                .status,
            0);
  const double reported =
      Json::parse(read_text(folder_.file("report.json")))["sah_cost"].get<double>();
  const Json results = Json::parse(read_text(folder_.file("b.json")));
  EXPECT_NEAR(results["models"][0]["predicted_cost"].get<double>(), reported, 1e-4 * reported);
}

TEST_F(Bench, JsonHasTheFieldsOfTheContractAndNoMismatch) {
  const Outcome run = bench({"--frames", "5", "--json", folder_.file("b.json")});
  ASSERT_EQ(run.status, 0) << run.err;
  const Json report = Json::parse(read_text(folder_.file("b.json")));
  EXPECT_THAT(names_of(report), testing::IsSupersetOf({"schema", "isa", "threads", "width",
                                                       "height", "models", "cpu", "command"}));
  EXPECT_EQ(report["schema"], "mdprep-bench/1");
  const Json& model = report["models"][0];
  EXPECT_EQ(names_of(model),
            (std::vector<std::string>{"file", "triangles", "keys", "clusters", "between_keys",
                                      "predicted_cost", "techniques"}));
  EXPECT_EQ(model["between_keys"], true);
  EXPECT_EQ(model["triangles"], TubeShape{}.triangles());
  EXPECT_EQ(model["keys"], kSampleKeys);
  ASSERT_EQ(model["techniques"].size() + 1, technique_table().size());
  for (const Json& row : model["techniques"]) {
    EXPECT_THAT(
        names_of(row),
        testing::IsSupersetOf(
            {"id", "pose_ms", "update_ms", "trace_ms", "shade_ms", "time_to_image_ms", "fps",
             "node_visits_per_ray", "leaf_triangles_per_ray", "triangle_tests_per_ray",
             "clusters_per_ray", "structure_bytes", "prebuild_ms", "hit_mismatches", "frames"}));
    EXPECT_EQ(row["round_medians_ms"].size(), 2u);
    EXPECT_NE(row["id"], "brute-force");
    EXPECT_GT(row["time_to_image_ms"], 0.0);
    if (find_technique(row["id"].get<std::string>()).kind != TechniqueKind::kPeer) {
      EXPECT_EQ(row["hit_mismatches"], 0) << row["id"];
      EXPECT_GT(row["node_visits_per_ray"], 0.0) << row["id"];
      EXPECT_GT(row["leaf_triangles_per_ray"], 0.0) << row["id"];
      EXPECT_GT(row["triangle_tests_per_ray"], 0.0) << row["id"];
    }
    const bool is_kd = row["id"] == "fuzzy-kdtree" || row["id"] == "static-kdtree";
    EXPECT_EQ(row.contains("kd_cost_ratio"), is_kd) << row["id"];
    if (is_kd) {
      EXPECT_NEAR(row["kd_cost_ratio"], kKdTestCost, 1e-6) << "alike for both";
    }
    EXPECT_GT(row["structure_bytes"], 0) << row["id"];
    ASSERT_EQ(row["frames"].size(), 5u);
    EXPECT_THAT(names_of(row["frames"][0]),
                testing::IsSupersetOf({"key", "time_to_image_ms", "update_ms", "trace_ms"}));
    EXPECT_EQ(row["frames"][0]["key"], 0);
    EXPECT_EQ(row["frames"][4]["key"], kSampleKeys - 1);
  }
}

TEST_F(Bench, CountsAreTheSameEveryTime) {
  const auto counts = [&](const std::string& threads) {
    EXPECT_EQ(
        bench({"--frames", "4", "--json", folder_.file("b.json"), "--threads", threads}).status, 0);
    const Json report = Json::parse(read_text(folder_.file("b.json")));
    std::vector<double> found;
    for (const Json& row : report["models"][0]["techniques"])
      if (find_technique(row["id"].get<std::string>()).kind != TechniqueKind::kAdaptive)
        for (const char* name : {"node_visits_per_ray", "leaf_triangles_per_ray",
                                 "triangle_tests_per_ray", "clusters_per_ray"})
          found.push_back(row[name]);
    for (const Json& row : report["models"][0]["techniques"])
      if (find_technique(row["id"].get<std::string>()).kind != TechniqueKind::kAdaptive)
        for (const Json& frame : row["frames"])
          for (const char* name :
               {"node_visits", "triangle_setups", "triangle_tests", "clusters_entered"})
            found.push_back(frame[name]);
    return found;
  };
  EXPECT_EQ(counts("1"), counts("2"));
}

TEST_F(Bench, AMismatchIsReportedAndIsAnInternalFault) {
  ModelStorage model = sample_model();
  for (std::size_t i = 0; i < model.fuzzy_trees.size(); ++i) {  // the trees know one triangle each
    const FuzzyTree& tree = model.fuzzy_trees[i];
    std::fill_n(model.kd_refs.begin() + tree.first_ref, tree.ref_count,
                model.clusters[i % model.clusters.size()].first_triangle);
  }
  write_mdk(model.view(), folder_.file("wrong.mdk"));
  const Outcome run = run_mdprep({"bench", folder_.file("wrong.mdk"), "--size", "128x128",
                                  "--rounds", "1", "-q", "--json", folder_.file("b.json")});
  EXPECT_EQ(run.status, 1);
  EXPECT_TRUE(is_one_sentence(run.err)) << run.err;
  const Json report = Json::parse(read_text(folder_.file("b.json")));
  for (const Json& row : report["models"][0]["techniques"])
    EXPECT_EQ(row["hit_mismatches"] > 0, row["id"] == "fuzzy-kdtree") << row["id"];
}

TEST_F(Bench, StdoutHoldsTheTableAlone) {
  const Outcome run = bench({"--frames", "2", "--techniques", "refit-bvh,fuzzy-kdtree", baked()});
  ASSERT_EQ(run.status, 0) << run.err;
  std::istringstream lines(run.out);
  std::string line;
  std::vector<std::string> first_words;
  while (std::getline(lines, line)) {
    std::istringstream words(line);
    std::string model, technique;
    words >> model >> technique;
    first_words.push_back(model + " " + technique);
  }
  EXPECT_EQ(first_words,
            (std::vector<std::string>{"model technique", "sample refit-bvh", "sample fuzzy-kdtree",
                                      "sample refit-bvh", "sample fuzzy-kdtree"}));
}

TEST_F(Bench, CsvHasOneRowPerTechnique) {
  const Outcome run = bench({"--frames", "2", "--csv", folder_.file("b.csv"), "-q"});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run.err, "");
  const std::string csv = read_text(folder_.file("b.csv"));
  EXPECT_EQ(static_cast<std::size_t>(std::count(csv.begin(), csv.end(), '\n')),
            technique_table().size());
}

TEST_F(Bench, MakesThePageForTwoTinyModels) {
  ASSERT_EQ(run_mdprep({"bake", source(), "-o", folder_.file("sample-split1.mdk"), "--report",
                        folder_.file("sample-split1.json"), "-q"})
                .status,
            0);
  const Outcome run = bench({folder_.file("sample-split1.mdk"), "--frames", "4", "--html",
                             folder_.file("b.html"), "--json", folder_.file("b.json"), "--markdown",
                             folder_.file("b.md"), "--commit", "abc1234", "-q"});
  ASSERT_EQ(run.status, 0) << run.err;
  const std::string page = read_text(folder_.file("b.html"));
  for (const TechniqueInfo& technique : technique_table())
    if (technique.kind != TechniqueKind::kOracle) {
      EXPECT_THAT(page, testing::HasSubstr("<code>" + std::string(technique.id) + "</code>"));
    }
  for (const char* word : {"commit abc1234", "id=\"crossover\"", "stopped by", "</html>"})
    EXPECT_THAT(page, testing::HasSubstr(word));
  const std::string document = read_text(folder_.file("b.md"));

  // The same page and document come from the results alone.
  const Outcome again =
      run_mdprep({"bench", "--from", folder_.file("b.json"), "--html", folder_.file("again.html"),
                  "--markdown", folder_.file("b.md"), "--json", folder_.file("again.json"), "-q"});
  ASSERT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(again.out, run.out);
  EXPECT_TRUE(read_text(folder_.file("again.html")) == page);
  EXPECT_TRUE(read_text(folder_.file("b.md")) == document);
  EXPECT_TRUE(read_text(folder_.file("again.json")) == read_text(folder_.file("b.json")));
}

TEST_F(Bench, BruteForceJudgesAsManyFramesAsAsked) {
  for (const auto& [asked, judged] :
       {std::pair{"all", 4}, {"1", 1}, {"3", 3}, {"9", 4}, {"none", 0}}) {
    const Outcome run = bench({"--frames", "4", "--techniques", "refit-bvh", "--judge", asked,
                               "--json", folder_.file("b.json"), "-q"});
    ASSERT_EQ(run.status, 0) << run.err;
    const Json report = Json::parse(read_text(folder_.file("b.json")));
    EXPECT_EQ(report["models"][0]["techniques"][0]["judged_frames"], judged);
  }
}

TEST_F(Bench, ComparesTwoResults) {
  for (const char* name : {"old.json", "new.json"})
    ASSERT_EQ(bench({"--frames", "3", "--techniques", "fuzzy-bvh,refit-bvh", "--json",
                     folder_.file(name), "-q"})
                  .status,
              0);
  const Outcome run =
      run_mdprep({"bench", "--compare", folder_.file("old.json"), folder_.file("new.json")});
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run.err, "");
  EXPECT_THAT(run.out, testing::HasSubstr("64x48"));
  EXPECT_THAT(run.out,
              testing::ContainsRegex("sample +fuzzy-bvh +[0-9.]+ +[0-9.]+ .* same +same\n"))
      << "counts are the same in two runs";
  EXPECT_THAT(run.out, testing::ContainsRegex("[0-9] faster, [0-9] the same, [0-9] slower\n$"));
}

TEST_F(Bench, QuotesResultsInADocument) {
  const std::string document = folder_.file("README.md");
  write_text(document, "a\n<!-- bench: techniques sample -->\nb\n<!-- end of bench -->\nc\n");
  const Outcome run = bench({"--frames", "2", "--techniques", "auto", "--quote", document, "-q"});
  ASSERT_EQ(run.status, 0) << run.err;
  const std::string text = read_text(document);
  EXPECT_EQ(text.rfind("a\n<!-- bench: techniques sample -->\n| technique |", 0), 0u) << text;
  EXPECT_THAT(text, testing::HasSubstr("| `auto` | "));
  EXPECT_THAT(text, testing::EndsWith("\n<!-- end of bench -->\nc\n"));
}

}  // namespace
}  // namespace mdk::test
