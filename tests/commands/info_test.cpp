// mdprep info, started as a user does.
#include <gmock/gmock.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/commands/baked_sample.h"
#include "tests/commands/program_run.h"
#include "tests/commands/sample_mesh.h"

namespace mdk::test {
namespace {

using testing::HasSubstr;
using Json = nlohmann::json;

class Info : public BakedSample {};

TEST_F(Info, TheHashOfOptionsTellsFilesApartExactlyWhereOptionsDo) {
  const auto hash_with = [&](std::vector<std::string> options) {
    options.insert(options.begin(), {"bake", source(), "-o", folder_.file("x.mdk"), "-q"});
    EXPECT_EQ(run_mdprep(options).status, 0);
    const Outcome info = run_mdprep({"info", folder_.file("x.mdk"), "--json"});
    return Json::parse(info.out)["options_hash"].get<std::string>();
  };
  const std::string usual = hash_with({});
  EXPECT_EQ(usual.size(), 16u);
  EXPECT_EQ(hash_with({"--fps", "30.0", "--threads", "1"}), usual);
  EXPECT_NE(hash_with({"--fps", "15"}), usual);
  EXPECT_NE(hash_with({"--refine", "off"}), usual);
  EXPECT_THAT(run_mdprep({"info", baked()}).out, HasSubstr("options " + usual));
}

TEST_F(Info, JsonTellsWhatWasBaked) {
  const Outcome run = run_mdprep({"info", baked(), "--json"});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run.err, "");
  const Json info = Json::parse(run.out);
  EXPECT_EQ(info["schema"], "mdprep-info/1");
  EXPECT_EQ(info["file"], baked());
  EXPECT_EQ("mdprep " + info["made_by"].get<std::string>() + "\n", run_mdprep({"--version"}).out);
  EXPECT_EQ(info["triangles"], TubeShape{}.triangles());
  EXPECT_EQ(info["vertices"], 13 * 16 + 8);
  EXPECT_EQ(info["keys"], kSampleKeys);
  EXPECT_EQ(info["clips"][1],
            Json::parse(R"({"name":"swing","seconds":0.5,"first_key":31,"keys":16})"));
  EXPECT_GE(info["clusters"], 2);
  EXPECT_EQ(info["segments"].front()["first_key"], 0);
  EXPECT_EQ(info["segments"].back()["last_key"], kSampleKeys - 1);
  EXPECT_EQ(info["materials"], 2);
  EXPECT_EQ(info["textures"], Json::array());
  EXPECT_LT(info["bounds"]["lo"][1], 0.01);
  EXPECT_GT(info["bounds"]["hi"][1], 1.99);
  const std::uint64_t file_bytes = std::filesystem::file_size(baked());
  EXPECT_EQ(info["file_bytes"], file_bytes);
  std::uint64_t section_bytes = 0;
  for (const Json& section : info["sections"])
    section_bytes += section["bytes"].get<std::uint64_t>();
  EXPECT_GT(section_bytes, file_bytes / 2);
  EXPECT_LT(section_bytes, file_bytes);
}

TEST_F(Info, AreasTellHowLooseTheBoxesAre) {
  const Json plain = Json::parse(run_mdprep({"info", baked(), "--json"}).out);
  EXPECT_FALSE(plain.contains("fuzzy_area"));
  const Json info = Json::parse(run_mdprep({"info", baked(), "--json", "--areas"}).out);
  EXPECT_GT(info["tight_area"], 0.1);
  EXPECT_GE(info["fuzzy_area"], info["tight_area"]) << "boxes for all times hold those of one";
  // Clusters that do not move have far looser boxes.
  ASSERT_EQ(
      run_mdprep({"bake", source(), "-o", folder_.file("one.mdk"), "--decompose", "none"}).status,
      0);
  const Json one =
      Json::parse(run_mdprep({"info", folder_.file("one.mdk"), "--json", "--areas"}).out);
  EXPECT_DOUBLE_EQ(one["tight_area"], info["tight_area"]);
  EXPECT_GT(one["fuzzy_area"], 1.5 * info["fuzzy_area"].get<double>());
  EXPECT_THAT(run_mdprep({"info", baked(), "--areas"}).out, HasSubstr("if they were tight"));
}

TEST_F(Info, TablesTellTheSameToPeople) {
  const Outcome run = run_mdprep({"info", baked()});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run.err, "");
  for (const char* text : {"triangles       396\n", "vertices        216\n", "bend", "swing",
                           "first key", "section", "rest pose"})
    EXPECT_THAT(run.out, HasSubstr(text));
}

}  // namespace
}  // namespace mdk::test
