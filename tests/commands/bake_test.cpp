// mdprep bake, started as a user does.
#include <gmock/gmock.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>

#include "common/base/isa.h"
#include "formats/files/file_kind.h"
#include "tests/commands/baked_sample.h"
#include "tests/commands/program_run.h"
#include "tests/commands/sample_mesh.h"
#include "tests/formats/assimp_samples.h"
#include "tests/formats/point_cache_builder.h"

namespace mdk::test {
namespace {

using Json = nlohmann::ordered_json;
using testing::HasSubstr;

std::vector<std::string> names_of(const Json& object) {
  std::vector<std::string> names;
  for (const auto& [name, value] : object.items()) names.push_back(name);
  return names;
}

class Bake : public BakedSample {};

TEST_F(Bake, TheReportHasExactlyTheFieldsOfTheContract) {
  const Outcome bake = run_mdprep(
      {"bake", source(), "-o", folder_.file("a.mdk"), "--report", folder_.file("a.json")});
  ASSERT_EQ(bake.status, 0) << bake.err;
  const Json report = Json::parse(read_text(folder_.file("a.json")));
  EXPECT_EQ(names_of(report),
            (std::vector<std::string>{
                "schema",   "input",       "read_through", "triangles",         "vertices",
                "keys",     "clips",       "clusters",     "segments",          "between_keys",
                "rest_key", "stop_reason", "residual_rms", "residual_max",      "quantization",
                "sah_cost", "refine_gain", "seconds",      "peak_memory_bytes", "file_bytes",
                "growth"}));
  EXPECT_EQ(names_of(report["seconds"]),
            (std::vector<std::string>{"read", "decompose", "build", "write", "total"}));
  EXPECT_EQ(report["schema"], "mdprep-bake/1");
  EXPECT_EQ(report["input"], source());
  EXPECT_TRUE(report["read_through"].is_null());
  EXPECT_EQ(report["triangles"], TubeShape{}.triangles());
  EXPECT_EQ(report["keys"], kSampleKeys);
  EXPECT_EQ(report["clips"], Json::parse(R"([{"name":"bend","seconds":1.0,"keys":31},
                                             {"name":"swing","seconds":0.5,"keys":16}])"));
  EXPECT_GE(report["segments"], 1);
  EXPECT_GE(report["refine_gain"], 0.0);
  EXPECT_LT(report["refine_gain"], 1.0);
  EXPECT_EQ(report["file_bytes"], std::filesystem::file_size(folder_.file("a.mdk")));
  EXPECT_GT(report["peak_memory_bytes"], 1u << 20);
  EXPECT_EQ(names_of(report["growth"][0]),
            (std::vector<std::string>{"clusters", "residual_rms", "fuzzy_area", "sah_cost"}));
  EXPECT_EQ(report["growth"][0]["clusters"], 1);
  EXPECT_GT(report["sah_cost"], 0.0);
  EXPECT_GE(report["clusters"], 2) << "a bending tube and a cube that swings round it";
  EXPECT_LE(report["residual_rms"], report["residual_max"]);
  EXPECT_LT(report["residual_rms"], 0.1);
  const double parts =
      report["seconds"]["read"].get<double>() + report["seconds"]["decompose"].get<double>() +
      report["seconds"]["build"].get<double>() + report["seconds"]["write"].get<double>();
  EXPECT_GT(parts, 0);
  EXPECT_LE(parts, report["seconds"]["total"].get<double>() * 1.001);
}

TEST_F(Bake, MakesTheSameBytesForAnyThreadCountAndInstructionSet) {
  const std::string expected = read_text(baked());
  std::vector<std::vector<std::string>> machines = {{"--threads", "1"}, {"--threads", "2"}};
  for (const std::string_view isa : available_isas())
    if (isa != "scalar") machines.push_back({"--isa", std::string(isa)});
  for (const auto& machine : machines) {
    std::vector<std::string> line = {"bake", source(), "-o", folder_.file("a.mdk"), "-q"};
    line.insert(line.end(), machine.begin(), machine.end());
    ASSERT_EQ(run_mdprep(line).status, 0);
    EXPECT_TRUE(read_text(folder_.file("a.mdk")) == expected) << machine[0] << machine[1];
  }
}

TEST_F(Bake, OptionsReachTheDecomposition) {
  const auto report_with = [&](std::vector<std::string> options) {
    std::vector<std::string> line = {
        "bake", source(), "-o", folder_.file("a.mdk"), "-q", "--report", folder_.file("a.json")};
    line.insert(line.end(), options.begin(), options.end());
    const Outcome bake = run_mdprep(line);
    EXPECT_EQ(bake.status, 0) << bake.err;
    return Json::parse(read_text(folder_.file("a.json")));
  };
  EXPECT_EQ(report_with({"--clusters", "4"})["clusters"], 4);
  EXPECT_EQ(report_with({"--clusters", "4"})["stop_reason"], "count");
  EXPECT_GT(report_with({"--clusters", "4"})["refine_gain"], 0.0);
  EXPECT_EQ(report_with({"--clusters", "4", "--refine", "off"})["refine_gain"], 0.0);
  EXPECT_EQ(report_with({"--stop", "50"})["stop_reason"], "percent");
  const Json counted = report_with({"--stop", "50", "--clusters", "5"});
  EXPECT_EQ(counted["stop_reason"], "count");
  EXPECT_EQ(counted["clusters"], 5);
  EXPECT_NE(counted["growth"], report_with({"--clusters", "5"})["growth"])
      << "not by the paper's method";
  EXPECT_EQ(report_with({"--decompose", "none"})["clusters"], 2) << "a tube and a cube";
  EXPECT_EQ(report_with({"--decompose", "none"})["stop_reason"], "none");
  const Json bones = report_with({"--decompose", "bones"});
  EXPECT_EQ(bones["stop_reason"], "bones");
  const Json posable = report_with({"--decompose", "bones", "--sampling", "pose-space"});
  EXPECT_EQ(posable["segments"], 1);
  EXPECT_GT(posable["sah_cost"], report_with({"--decompose", "bones", "--sampling", "pose-space",
                                              "--joint-limit", "10"})["sah_cost"]);
  EXPECT_EQ(report_with({"--segments", "1"})["segments"], 1);
  EXPECT_EQ(report_with({"--segments", "5"})["segments"], 5);
  EXPECT_EQ(report_with({"--segments", "1000"})["segments"], kSampleKeys - 2);
  EXPECT_EQ(report_with({"--rest-pose", "13"})["rest_key"], 13);
  EXPECT_EQ(report_with({"--fps", "10"})["keys"], 11 + 6);
  EXPECT_EQ(report_with({"--clips", "swing"})["keys"], 16);
  EXPECT_EQ(report_with({"--clips", "swing,bend"})["keys"], kSampleKeys);
}

TEST_F(Bake, BoxesOfKeysOnlyAreSaidInEveryReportAndTracedAtKeys) {
  const std::string file = folder_.file("keys.mdk");
  const auto json_of = [](const Outcome& run) {
    EXPECT_EQ(run.status, 0) << run.err;
    return Json::parse(run.out);
  };
  const Outcome bake = run_mdprep({"bake", source(), "-o", file, "--between-keys", "off",
                                   "--report", folder_.file("keys.json")});
  ASSERT_EQ(bake.status, 0) << bake.err;
  EXPECT_THAT(bake.err, HasSubstr("boxes at keys only"));
  EXPECT_EQ(Json::parse(read_text(folder_.file("keys.json")))["between_keys"], false);
  EXPECT_EQ(json_of(run_mdprep({"info", file, "--json"}))["between_keys"], false);
  EXPECT_EQ(json_of(run_mdprep({"info", baked(), "--json"}))["between_keys"], true);
  EXPECT_THAT(run_mdprep({"info", file}).out, HasSubstr("at keys only"));
  const Json verified = json_of(run_mdprep({"verify", file, "--json", "-q"}));
  EXPECT_EQ(verified["between_keys"], false);
  EXPECT_EQ(verified["samples"], 0);
  EXPECT_EQ(verified["ok"], true);
  EXPECT_THAT(run_mdprep({"verify", file, "-q"}).out, HasSubstr("no time between keys"));
  const std::string bench = folder_.file("bench.json");
  ASSERT_EQ(run_mdprep({"bench", file, "--techniques", "fuzzy-kdtree,fuzzy-bvh", "--size", "64x64",
                        "--frames", "3", "--rounds", "1", "--json", bench, "-q"})
                .status,
            0);
  const Json model = Json::parse(read_text(bench))["models"][0];
  EXPECT_EQ(model["between_keys"], false);
  for (const Json& technique : model["techniques"]) EXPECT_EQ(technique["hit_mismatches"], 0);

  // A time between keys is the picture of the nearest key.
  const auto picture = [&](std::vector<std::string> when, const std::string& name) {
    std::vector<std::string> line = {"render", file,    "-o", folder_.file(name),
                                     "--size", "64x64", "-q"};
    line.insert(line.end(), when.begin(), when.end());
    const Outcome run = run_mdprep(line);
    EXPECT_EQ(run.status, 0) << run.err;
    return read_text(folder_.file(name));
  };
  const std::string nearest = picture({"--frames", "3"}, "key.png");
  const std::string stats = folder_.file("stats.json");
  picture({"--time", "0.11", "--stats", stats}, "stats.png");
  const Json rendered = Json::parse(read_text(stats));
  EXPECT_EQ(rendered["between_keys"], false);
  EXPECT_EQ(rendered["frames"][0]["key"], 3);
  EXPECT_NEAR(rendered["frames"][0]["time"].get<double>(), 0.1, 1e-6) << "of the key shown";
  EXPECT_EQ(picture({"--time", "0.11"}, "time.png"), nearest);
  EXPECT_NE(picture({"--time", "0.4"}, "later.png"), nearest);
}

TEST_F(Bake, TheDepfileNamesEveryFileThatWasRead) {
  std::filesystem::create_directory(folder_.file("my files"));
  const std::string input = folder_.file("my files/tube.gltf");
  write_sample_gltf(input);
  const Outcome bake = run_mdprep(
      {"bake", input, "-o", folder_.file("a.mdk"), "-q", "--depfile", folder_.file("a.d")});
  ASSERT_EQ(bake.status, 0) << bake.err;
  const std::string folder = folder_.path() + "/my\\ files/";
  EXPECT_EQ(read_text(folder_.file("a.d")), folder_.file("a.mdk") + ": \\\n  " + folder +
                                                "tube.gltf \\\n  " + folder + "tube.bin\n");
}

TEST_F(Bake, WhatAssimpReadIsSaidByNoteReportAndInfo) {
  write_text(folder_.file("Bar.MD5MESH"), bending_md5mesh());
  write_text(folder_.file("Bar.md5anim"), bending_md5anim());
  const std::string input = folder_.file("Bar.MD5MESH"), baked = folder_.file("bar.mdk");
  const Outcome bake = run_mdprep({"bake", input, "-o", baked, "-v", "--report",
                                   folder_.file("bar.json"), "--depfile", folder_.file("bar.d")});
  if (!has_assimp()) {
    EXPECT_EQ(bake.status, 3);
    EXPECT_THAT(bake.err, HasSubstr("libassimp-dev"));
    GTEST_SKIP() << "Assimp was not there when this was built";
  }
  ASSERT_EQ(bake.status, 0) << bake.err;
  EXPECT_THAT(bake.err, HasSubstr("Bar.MD5MESH was read through Assimp"));
  EXPECT_THAT(Json::parse(read_text(folder_.file("bar.json")))["read_through"].get<std::string>(),
              testing::StartsWith("Assimp "));
  EXPECT_THAT(read_text(folder_.file("bar.d")), HasSubstr("Bar.md5anim"));
  EXPECT_THAT(run_mdprep({"info", baked}).out, HasSubstr("source read through Assimp"));
  EXPECT_EQ(Json::parse(run_mdprep({"info", baked, "--json"}).out)["read_through"], "Assimp");
  const Outcome verify = run_mdprep({"verify", baked, "--source", input});
  EXPECT_EQ(verify.status, 0) << verify.out;
}

TEST_F(Bake, ProgressAndSummaryGoToStderrAlone) {
  const Outcome plain = run_mdprep({"bake", source(), "-o", folder_.file("a.mdk")});
  EXPECT_EQ(plain.status, 0);
  EXPECT_EQ(plain.out, "");
  EXPECT_THAT(plain.err, HasSubstr("396 triangles"));
  EXPECT_THAT(plain.err, testing::Not(HasSubstr("\r"))) << "stderr is no terminal";
  const Outcome bar =
      run_mdprep({"bake", source(), "-o", folder_.file("a.mdk"), "--progress", "always"});
  EXPECT_EQ(bar.out, "");
  EXPECT_THAT(bar.err, HasSubstr("\r"));
  const Outcome lines =
      run_mdprep({"bake", source(), "-o", folder_.file("a.mdk"), "--progress", "plain"});
  EXPECT_THAT(lines.err, testing::Not(HasSubstr("\r")));
  const Outcome never =
      run_mdprep({"bake", source(), "-o", folder_.file("a.mdk"), "--progress", "never"});
  EXPECT_THAT(never.err, testing::Not(HasSubstr(" %  ")));
  EXPECT_THAT(never.err, HasSubstr("396 triangles"));
}

TEST_F(Bake, AFailedBakeLeavesAnOldOutputAsItWas) {
  write_text(folder_.file("a.mdk"), "old");
  write_text(folder_.file("broken.gltf"), "{");
  EXPECT_EQ(run_mdprep({"bake", folder_.file("broken.gltf"), "-o", folder_.file("a.mdk")}).status,
            3);
  EXPECT_EQ(read_text(folder_.file("a.mdk")), "old");
  EXPECT_EQ(folder_.names(), (std::vector<std::string>{"a.mdk", "broken.gltf"}));
}

TEST_F(Bake, WhatATerminalWouldObeyIsNotPrinted) {
  const std::string path = folder_.file("a.gltf");
  write_text(path, R"({"asset": {"version": "2.0"}, "extensionsRequired": ["\u001b[2J\nx"]})");
  const Outcome outcome = run_mdprep({"bake", path, "-o", folder_.file("a.mdk")});
  EXPECT_EQ(outcome.status, 3);
  EXPECT_TRUE(is_one_sentence(outcome.err)) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("needs the extension ?[2J?x, which is not supported"));
}

TEST_F(Bake, StoppedFromTheKeyboardItLeavesNothing) {
  write_sample_gltf(folder_.file("long.gltf"), {600, 64});
  ProgramRun bake(
      {"bake", folder_.file("long.gltf"), "-o", folder_.file("long.mdk"), "--progress", "always"});
  for (int i = 0; i < 600 && bake.err_so_far().empty(); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  bake.send_signal(SIGINT);
  const Outcome outcome = bake.wait();
  EXPECT_EQ(outcome.status, 130);
  EXPECT_THAT(outcome.err, HasSubstr("mdprep: interrupted"));
  EXPECT_EQ(folder_.names(), (std::vector<std::string>{"long.bin", "long.gltf"}));
}

/// A square that folds along its diagonal, and a fourth of a second between its frames.
class BakeCache : public Bake {
 protected:
  void SetUp() override {
    Bake::SetUp();
    write_text(mesh_, "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
    std::vector<Vec3f> points;
    for (const float height : {0.f, 0.5f, 1.f}) {
      const std::vector<Vec3f> pose = {{0, 0, 0}, {1, 0, height}, {1, 1, 0}, {0, 1, 0}};
      points.insert(points.end(), pose.begin(), pose.end());
    }
    const CacheBytes bytes = pc2_bytes(3, points);
    write_text(cache_, {bytes.begin(), bytes.end()});
  }

  const std::string mesh_ = folder_.file("fold.obj"), cache_ = folder_.file("wing.pc2");
  const std::string baked_ = folder_.file("fold.mdk");
};

TEST_F(BakeCache, AMeshAndItsPointCacheMakeOneClip) {
  const Outcome bake = run_mdprep({"bake", mesh_, cache_, "-o", baked_, "--fps", "4", "--report",
                                   folder_.file("r.json"), "--depfile", folder_.file("r.d")});
  ASSERT_EQ(bake.status, 0) << bake.err;
  const Json report = Json::parse(read_text(folder_.file("r.json")));
  EXPECT_EQ(report["input"], mesh_ + " " + cache_);
  EXPECT_EQ(report["triangles"], 2);
  EXPECT_EQ(report["clips"], Json::parse(R"([{"name":"wing","seconds":0.5,"keys":3}])"));
  EXPECT_THAT(read_text(folder_.file("r.d")), HasSubstr(mesh_));
  EXPECT_THAT(read_text(folder_.file("r.d")), HasSubstr(cache_));
  const Outcome same =
      run_mdprep({"verify", baked_, "--source", mesh_, "--source", cache_, "--fps", "4"});
  EXPECT_EQ(same.status, 0) << same.out << same.err;
  EXPECT_EQ(run_mdprep({"verify", baked_, "--source", mesh_}).status, 3) << "one key is not three";
}

TEST_F(BakeCache, PosesCanBeQuantisedWithinABoundThatInfoAndVerifyKnow) {
  const Outcome bake = run_mdprep({"bake", mesh_, cache_, "-o", baked_, "--fps", "4", "--quantize",
                                   "0.001", "--report", folder_.file("r.json")});
  ASSERT_EQ(bake.status, 0) << bake.err;
  const Json report = Json::parse(read_text(folder_.file("r.json")))["quantization"];
  EXPECT_EQ(report["bound"], 0.001);
  EXPECT_LE(report["largest"], 0.001);
  const Json poses = Json::parse(run_mdprep({"info", baked_, "--json"}).out)["poses"];
  EXPECT_EQ(poses["kind"], "quantized");
  EXPECT_EQ(poses["largest_error"], report["largest"]);
  EXPECT_THAT(run_mdprep({"info", baked_}).out, HasSubstr("(bound 0.10000 %)"));
  const Outcome same =
      run_mdprep({"verify", baked_, "--source", mesh_, "--source", cache_, "--fps", "4"});
  EXPECT_EQ(same.status, 0) << same.out << same.err;
}

TEST_F(Bake, BonesThatTakeLessRoomStayExact) {
  const Outcome bake =
      run_mdprep({"bake", source(), "-o", folder_.file("a.mdk"), "--quantize", "0.001", "-v"});
  EXPECT_EQ(bake.status, 0);
  EXPECT_THAT(bake.err, HasSubstr("poses stay exact"));
  EXPECT_EQ(Json::parse(run_mdprep({"info", folder_.file("a.mdk"), "--json"}).out)["poses"]["kind"],
            "rig");
}

TEST_F(BakeCache, AMeshAloneIsOneKey) {
  ASSERT_EQ(run_mdprep({"bake", mesh_, "-o", baked_, "--report", folder_.file("r.json")}).status,
            0);
  EXPECT_EQ(Json::parse(read_text(folder_.file("r.json")))["keys"], 1);
}

TEST_F(BakeCache, InputsAreNeverOverwritten) {
  const std::string before = read_text(cache_);
  EXPECT_EQ(run_mdprep({"bake", mesh_, cache_, "-o", cache_}).status, 2);
  EXPECT_EQ(read_text(cache_), before);
}

TEST_F(BakeCache, ClipsAreChosenByTheNameOfTheCache) {
  EXPECT_EQ(run_mdprep({"bake", mesh_, cache_, "-o", baked_, "--clips", "wing"}).status, 0);
  const Outcome none = run_mdprep({"bake", mesh_, cache_, "-o", baked_, "--clips", "fold"});
  EXPECT_EQ(none.status, 2);
  EXPECT_THAT(none.err, HasSubstr("\"wing\""));
}

}  // namespace
}  // namespace mdk::test
