// What the program says and returns when it is asked, and when it is used wrongly.
#include <gmock/gmock.h>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <nlohmann/json.hpp>

#include "common/trace/technique.h"
#include "tests/commands/baked_sample.h"
#include "tests/commands/program_run.h"
#include "tests/commands/sample_mesh.h"

namespace mdk::test {
namespace {

using testing::HasSubstr;

void expect_refused(const std::vector<std::string>& arguments, int status) {
  const Outcome run = run_mdprep(arguments);
  std::string line;
  for (const std::string& word : arguments) line += word + " ";
  EXPECT_EQ(run.status, status) << line << "\n" << run.err;
  EXPECT_TRUE(is_one_sentence(run.err)) << line << "\n" << run.err;
  EXPECT_EQ(run.out, "") << line;
}

class CommandLine : public BakedSample {
 protected:
  std::string out(const std::string& name) const { return folder_.file(name); }
};

TEST_F(CommandLine, HelpOfEverySubcommandGoesToStdoutWithAnExample) {
  for (const char* name : {"bake", "info", "verify", "render", "bench"}) {
    const Outcome help = run_mdprep({name, "--help"});
    EXPECT_EQ(help.status, 0);
    EXPECT_EQ(help.err, "");
    EXPECT_THAT(help.out, HasSubstr("--threads"));
    EXPECT_THAT(help.out, HasSubstr("--isa"));
    EXPECT_THAT(help.out, HasSubstr(std::string("Example:\n  mdprep ") + name));
  }
}

TEST_F(CommandLine, HelpNamesEveryTechniqueThereIs) {
  const std::string render = run_mdprep({"render", "--help"}).out;
  const std::string bench = run_mdprep({"bench", "--help"}).out;
  for (const TechniqueInfo& technique : technique_table()) {
    EXPECT_THAT(render, HasSubstr(std::string(technique.id)));
    EXPECT_THAT(bench, HasSubstr(std::string(technique.id)));
  }
}

TEST_F(CommandLine, HelpAndVersionOfTheProgram) {
  const Outcome help = run_mdprep({"--help"});
  EXPECT_EQ(help.status, 0);
  for (const char* name : {"bake", "info", "verify", "render", "bench", "Exit status"})
    EXPECT_THAT(help.out, HasSubstr(name));
  const Outcome version = run_mdprep({"--version"});
  EXPECT_EQ(version.status, 0);
  EXPECT_EQ(version.out.rfind("mdprep ", 0), 0u);
}

TEST_F(CommandLine, WrongUseIsStatus2AndOneSentence) {
  const std::vector<std::vector<std::string>> lines = {
      {},
      {"brew"},
      {"--fps", "30"},
      {"bake"},
      {"bake", source()},
      {"bake", source(), "-o"},
      {"bake", source(), "-o", ""},
      {"bake", source(), "-o", out("x.mdk"), "--nonsense"},
      {"bake", source(), "another.glb", "-o", out("x.mdk")},
      {"bake", source(), "cow.pc2", "-o", out("x.mdk")},
      {"bake", "cow.obj", "another.ply", "-o", out("x.mdk")},
      {"bake", "cow.obj", "cow.pc2", "cow.mdd", "-o", out("x.mdk")},
      {"bake", "cow.pc2", "-o", out("x.mdk")},
      {"bake", source(), "-o", source()},
      {"bake", source(), "-o", out("x.mdk"), "--report", out("x.mdk")},
      {"bake", source(), "-o", out("x.mdk"), "--fps", "0"},
      {"bake", source(), "-o", out("x.mdk"), "--fps", "nan"},
      {"bake", source(), "-o", out("x.mdk"), "--fps", "30", "--fps", "60"},
      {"bake", source(), "-o", out("x.mdk"), "--clips", "bend,"},
      {"bake", source(), "-o", out("x.mdk"), "--clips", "dance"},
      {"bake", source(), "-o", out("x.mdk"), "--decompose", "maybe"},
      {"bake", source(), "-o", out("x.mdk"), "--clusters", "0"},
      {"bake", source(), "-o", out("x.mdk"), "--clusters", "1000000"},
      {"bake", source(), "-o", out("x.mdk"), "--stop", "100"},
      {"bake", source(), "-o", out("x.mdk"), "--stop", "often"},
      {"bake", source(), "-o", out("x.mdk"), "--refine", "perhaps"},
      {"bake", source(), "-o", out("x.mdk"), "--quantize", "0"},
      {"bake", source(), "-o", out("x.mdk"), "--quantize", "fine"},
      {"bake", source(), "-o", out("x.mdk"), "--between-keys", "maybe"},
      {"bake", source(), "-o", out("x.mdk"), "--decompose", "bones", "--sampling", "pose-space",
       "--between-keys", "off"},
      {"bake", source(), "-o", out("x.mdk"), "--decompose", "none", "--stop", "5"},
      {"bake", source(), "-o", out("x.mdk"), "--rest-pose", "47"},
      {"bake", source(), "-o", out("x.mdk"), "--rest-pose", "first"},
      {"bake", source(), "-o", out("x.mdk"), "--threads", "0"},
      {"bake", source(), "-o", out("x.mdk"), "--isa", "mmx"},
      {"bake", source(), "-o", out("x.mdk"), "--progress", "loud"},
      {"bake", source(), "-o", out("x.mdk"), "--memory-limit", "much"},
      {"bake", source(), "-o", out("x.mdk"), "-q", "-v"},
      {"info", baked(), "--xml"},
      {"info", baked(), "--threads", "many"},
      {"verify", baked(), "--samples", "0"},
      {"verify", baked(), "--seed", "-1"},
      {"verify", baked(), "--fps", "30"},
      {"render", baked()},
      {"render", baked(), "-o", out("x.png")},
      {"render", baked(), "-o", out("x#.png"), "--technique", "magic"},
      {"render", baked(), "-o", out("x#.png"), "--shading", "magic"},
      {"render", baked(), "-o", out("x#.png"), "--clip", "dance"},
      {"render", baked(), "-o", out("x#.png"), "--time", "1.01"},
      {"render", baked(), "-o", out("x#.png"), "--time", "-0.1"},
      {"render", baked(), "-o", out("x#.png"), "--frames", "0:47"},
      {"render", baked(), "-o", out("x#.png"), "--frames", "0:1", "--time", "0"},
      {"render", baked(), "-o", out("x#.png"), "--frames", "0:1", "--clip", "bend"},
      {"render", baked(), "-o", out("x#.png"), "--size", "0x0"},
      {"render", baked(), "-o", out("x#.png"), "--camera", "1 2 3"},
      {"render", baked(), "-o", out("x#.png"), "--samples", "0"},
      {"render", baked(), "-o", baked(), "--frames", "0"},
      {"bench"},
      {"bench", baked(), "--techniques", "fuzzy-kdtree,magic"},
      {"bench", baked(), "--frames", "0"},
      {"bench", baked(), "--rounds", "0"},
      {"bench", baked(), "--json", out("x"), "--csv", out("x")},
      {"bench", baked(), "--html", out("x"), "--json", out("x")},
      {"bench", baked(), "--html", baked()},
      {"bench", baked(), "--judge", "0"},
      {"bench", baked(), "--markdown", out("x.html")},
      {"bench", baked(), "--techniques", ""},
      {"bench", baked(), "--techniques", "embree9", "--html", out("x.html")},
      {"bench", baked(), "--size", "0x512", "--html", out("x.html")},
      {"bench", baked(), "--size", "0x0"},
      {"bench", baked(), "--frames", "-1"},
      {"bench", baked(), "--from", out("x.json")},
      {"bench", "--compare", out("x.json")},
      {"bench", baked(), "--compare", out("x.json"), out("y.json")},
  };
  for (const auto& line : lines) expect_refused(line, 2);
  EXPECT_EQ(folder_.names(), std::vector<std::string>{});
}

TEST_F(CommandLine, FilesThatCannotBeReadOrWrittenAreStatus4) {
  expect_refused({"bake", out("missing.glb"), "-o", out("x.mdk")}, 4);
  expect_refused({"info", out("missing.mdk")}, 4);
  expect_refused({"verify", out("missing.mdk")}, 4);
  expect_refused({"render", out("missing.mdk"), "-o", out("x.png")}, 4);
  expect_refused({"bench", baked(), out("missing.mdk")}, 4);
  expect_refused({"bake", source(), "-o", out("no/folder/x.mdk")}, 4);
  expect_refused({"bake", source(), "-o", folder_.path()}, 4);
  expect_refused({"bake", source(), "-o", out("x.mdk"), "--report", out("no/x.json")}, 4);
  expect_refused({"bake", source(), "-o", out("x.mdk"), "--depfile", out("no/x.d")}, 4);
  expect_refused({"render", baked(), "-o", out("no/x#.png")}, 4);
  expect_refused({"bench", baked(), out("missing.mdk"), "--html", out("x.html")}, 4);
  for (const char* option : {"--json", "--csv", "--html", "--markdown"})
    expect_refused({"bench", baked(), option, out("no/x.md")}, 4);
  expect_refused({"bench", "--from", out("missing.json"), "--html", out("x.html")}, 4);
  expect_refused({"bench", "--compare", out("missing.json"), out("missing.json")}, 4);
  EXPECT_EQ(folder_.names(), std::vector<std::string>{});
}

TEST_F(CommandLine, ContentThatCannotBeUsedIsStatus3) {
  write_text(out("text.glb"), "This is no glTF.\n");
  write_text(out("text.mdk"), "This is no image.\n");
  write_text(out("cow.obj"), "v 0 0 0\n");
  write_text(out("empty.mdk"), "");
  const std::string whole = read_text(baked());
  write_text(out("cut.mdk"), whole.substr(0, whole.size() / 2));
  const std::vector<std::string> before = folder_.names();
  expect_refused({"bake", out("text.glb"), "-o", out("x.mdk")}, 3);
  expect_refused({"bake", out("cow.obj"), "-o", out("x.mdk")}, 3);
  expect_refused({"bake", folder_.path(), "-o", out("x.mdk")}, 3);
  for (const char* name : {"text.mdk", "empty.mdk", "cut.mdk"}) {
    expect_refused({"info", out(name)}, 3);
    expect_refused({"verify", out(name)}, 3);
    expect_refused({"render", out(name), "-o", out("x#.png")}, 3);
    expect_refused({"bench", out(name)}, 3);
    expect_refused({"bench", baked(), out(name), "--html", out("x.html")}, 3);
    expect_refused({"bench", "--from", out(name), "--html", out("x.html")}, 3);
  }
  EXPECT_EQ(folder_.names(), before);
}

TEST_F(CommandLine, TooLittleMemoryIsStatus5) {
  if (std::string(MDK_SANITIZE) != "") GTEST_SKIP() << "a sanitizer takes more than the limit";
  for (const char* limit : {"1M", "10M"})
    expect_refused({"bake", source(), "-o", out("x.mdk"), "--memory-limit", limit}, 5);
  expect_refused({"render", baked(), "-o", out("x.png"), "--frames", "0", "--size", "8000x8000",
                  "--memory-limit", "100M", "--progress", "never"},
                 5);
  EXPECT_EQ(folder_.names(), std::vector<std::string>{});
  EXPECT_EQ(run_mdprep({"bake", source(), "-o", out("x.mdk"), "--memory-limit", "1G"}).status, 0);
}

TEST_F(CommandLine, AnyMemoryLimitIsKeptOrSaidToBeTooLow) {
  if (std::string(MDK_SANITIZE) != "") GTEST_SKIP() << "a sanitizer takes more than the limit";
  write_sample_gltf(out("large.gltf"), {200, 64});
  int done = 0, refused = 0;
  for (int megabytes = 20; megabytes <= 100; megabytes += 10) {
    const std::uint64_t bytes = static_cast<std::uint64_t>(megabytes) << 20;
    const Outcome run =
        run_mdprep({"bake", out("large.gltf"), "-o", out("x.mdk"), "--threads", "4", "--refine",
                    "off", "--memory-limit", std::to_string(bytes), "--report", out("x.json")});
    EXPECT_THAT(run.status, testing::AnyOf(0, 5)) << megabytes << " MiB: " << run.err;
    (run.status == 0 ? done : refused) += 1;
    if (run.status != 0) continue;
    const auto report = nlohmann::json::parse(read_text(out("x.json")));
    EXPECT_LE(report["peak_memory_bytes"].get<std::uint64_t>(), bytes);
  }
  EXPECT_GT(done, 0);
  EXPECT_GT(refused, 0);
}

TEST_F(CommandLine, APictureTooLargeIsStatus5) {
  expect_refused({"render", baked(), "-o", out("x#.png"), "--size", "16385x1"}, 5);
  expect_refused({"bench", baked(), "--size", "1x1000000"}, 5);
  expect_refused({"bench", baked(), "--size", "100000x100000", "--html", out("x.html")}, 5);
  EXPECT_EQ(folder_.names(), std::vector<std::string>{});
}

TEST_F(CommandLine, AnUnreadableExtensionIsNamed) {
  const Outcome run = run_mdprep({"bake", "cow.STL", "-o", out("x.mdk")});
  EXPECT_EQ(run.status, 3);
  EXPECT_THAT(run.err, HasSubstr("cow.STL: files that end in .stl cannot be read"));
}

TEST_F(CommandLine, AFullDiskUnderStdoutIsNoSuccess) {
  if (!std::ifstream("/dev/full")) GTEST_SKIP() << "there is no /dev/full";
  const std::string line = "'" MDPREP_PATH "' info '" + baked() + "' > /dev/full 2> /dev/null";
  EXPECT_EQ(WEXITSTATUS(std::system(line.c_str())), 4);
}

}  // namespace
}  // namespace mdk::test
