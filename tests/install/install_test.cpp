// Installs what was built into a folder, moves the folder, and uses it there.
#include <gmock/gmock.h>

#include <filesystem>
#include <sstream>

#include "tests/batch/batch_folder.h"

namespace mdk::test {
namespace {

using testing::HasSubstr;
using testing::Not;

class Installed : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new BatchFolder;
    const Outcome install =
        folder_->shell(MDK_CMAKE " --install " MDK_BUILD_DIR " --prefix \"$PWD/first place\"");
    ASSERT_EQ(install.status, 0) << install.out << install.err;
    ASSERT_EQ(folder_->shell("mv 'first place' 'second place'").status, 0);
    folder_->write_source("a", 1);
  }
  static void TearDownTestSuite() { delete folder_; }

  /// A line of shell with the installed programs first on the PATH.
  static Outcome shell(const std::string& line) {
    return folder_->shell("export PATH=\"$PWD/second place/bin:$PATH\"; " + line);
  }

  static BatchFolder* folder_;
};

BatchFolder* Installed::folder_ = nullptr;

TEST_F(Installed, ProgramsRunWhereverThePrefixIs) {
  const Outcome bake = shell("command -v mdprep && mdprep bake a.gltf -o a.mdk -q");
  ASSERT_EQ(bake.status, 0) << bake.err;
  EXPECT_THAT(bake.out, HasSubstr("second place/bin/mdprep"));
  ASSERT_EQ(
      run_mdprep({"bake", folder_->file("a.gltf"), "-o", folder_->file("b.mdk"), "-q"}).status, 0);
  EXPECT_TRUE(folder_->read("a.mdk") == folder_->read("b.mdk"));
  EXPECT_EQ(shell("grep -rl 'first place' 'second place/lib' 'second place/share'").out, "");
}

TEST_F(Installed, HeadersAreThePublicOnesAlone) {
  const Outcome installed = shell("cd 'second place/include' && find . -type f | sort");
  EXPECT_EQ(installed.out,
            shell("cd " MDK_SOURCE_DIR "/common/include && find . -type f | sort").out);
  EXPECT_THAT(installed.out, HasSubstr("./mdk/ray_query.h\n"));
}

TEST_F(Installed, PackageAsksForNothingThatTracingDoesNotLink) {
  const std::string package = "'second place'/lib*/cmake/mdk 'second place'/lib*/*/cmake/mdk";
  EXPECT_THAT(shell("grep -rh TBB " + package).out, HasSubstr("TBB"));
  EXPECT_EQ(shell("grep -riE 'embree|png|ffp-contract|cxx_std_20|defaults' " + package).out, "");
}

/// Configures and builds a project that uses the installed library, as C++17, where neither Embree
/// nor libpng can be found.
Outcome build_client(const BatchFolder& folder, const std::string& source,
                     const std::string& build) {
  return folder.shell(MDK_CMAKE " -S " + source + " -B " + build +
                      " -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_COMPILER=" MDK_CXX
                      " -DCMAKE_CXX_FLAGS='-Wall -Wextra -Wconversion -Werror'"
                      " -DCMAKE_EXPORT_COMPILE_COMMANDS=ON -DCMAKE_DISABLE_FIND_PACKAGE_PNG=ON"
                      " -DCMAKE_DISABLE_FIND_PACKAGE_embree=ON"
                      " -DCMAKE_PREFIX_PATH=\"$PWD/second place\" && " MDK_CMAKE " --build " +
                      build);
}

TEST_F(Installed, AnotherProjectFindsTheLibraryAndTracesRays) {
  if (std::string(MDK_SANITIZE) != "") GTEST_SKIP() << "the example is built without sanitizers";
  ASSERT_EQ(shell("mdprep bake a.gltf -o swept.mdk -q").status, 0);
  const Outcome build = build_client(*folder_, MDK_SOURCE_DIR "/examples/ray_sweep", "example");
  ASSERT_EQ(build.status, 0) << build.out << build.err;
  const std::string commands = folder_->read("example/compile_commands.json");
  EXPECT_THAT(commands, HasSubstr("++17"));
  EXPECT_THAT(commands, Not(HasSubstr("++20")));
  EXPECT_THAT(commands, Not(HasSubstr("-ffp-contract")));
  const Outcome run = shell("example/ray_sweep swept.mdk");
  ASSERT_EQ(run.status, 0) << run.err;
  int hits = 0, all = 0;
  std::istringstream(run.out) >> hits;
  std::istringstream(run.out.substr(run.out.find("of ") + 3)) >> all;
  EXPECT_EQ(all, 3600);
  EXPECT_GT(hits, 100) << "two squares, seen from the side";
  EXPECT_LT(hits, all);
  EXPECT_EQ(shell("example/ray_sweep none.mdk").status, 4);
}

TEST_F(Installed, TheProgramInTheDocumentationHitsTheHand) {
  if (std::string(MDK_SANITIZE) != "") GTEST_SKIP() << "the example is built without sanitizers";
  ASSERT_EQ(shell("mdprep bake " MDK_SOURCE_DIR "/assets/hand.glb -o hand.mdk -q && mkdir doc && "
                  "cp " MDK_SOURCE_DIR "/examples/ray_sweep/CMakeLists.txt doc && "
                  "sed -n '/^```cpp/,/^```/p' 'second place/share/doc/libmdk-dev/ray-queries.md' | "
                  "grep -v '^```' > doc/main.cpp")
                .status,
            0);
  const Outcome build = build_client(*folder_, "doc", "doc/build");
  ASSERT_EQ(build.status, 0) << build.out << build.err;
  const Outcome run = shell("doc/build/ray_sweep");
  ASSERT_EQ(run.status, 0) << run.err;
  int hits = 0;
  std::istringstream(run.out) >> hits;
  EXPECT_GT(hits, 100) << run.out;
  EXPECT_LT(hits, 10'000) << run.out;
  EXPECT_THAT(run.out, HasSubstr("m away"));
}

TEST_F(Installed, TheCProgramInTheDocumentationNeedsPkgConfigAlone) {
  if (std::string(MDK_SANITIZE) != "") GTEST_SKIP() << "the example is built without sanitizers";
  const Outcome build =
      shell("test -f hand.mdk || mdprep bake " MDK_SOURCE_DIR
            "/assets/hand.glb -o hand.mdk -q; "
            "sed -n '/^```c$/,/^```/p' 'second place/share/doc/libmdk-dev/library.md' | "
            "grep -v '^```' > program.c && "
            "export PKG_CONFIG_PATH=$(dirname \"$(find \"$PWD/second place\" -name mdk.pc)\") && "
            "eval cc -std=c99 -Wall -Wextra -Wconversion -Werror program.c -o program "
            "$(pkg-config --cflags --libs mdk)");
  ASSERT_EQ(build.status, 0) << build.out << build.err;
  const Outcome run = shell(
      "LD_LIBRARY_PATH=$(dirname \"$(find \"$PWD/second place\" -name libmdk.so.0)\") ./program");
  EXPECT_EQ(run.status, 0) << run.err;
  int hits = 0;
  std::istringstream(run.out) >> hits;
  EXPECT_GT(hits, 10) << run.out;
}

TEST_F(Installed, TheLidarIsTheSameInCppAndInPython) {
  if (std::string(MDK_SANITIZE) != "") GTEST_SKIP() << "the example is built without sanitizers";
  const Outcome build = build_client(*folder_, MDK_SOURCE_DIR "/examples/lidar", "lidar");
  ASSERT_EQ(build.status, 0) << build.out << build.err;
  const Outcome run =
      shell("test -f hand.mdk || mdprep bake " MDK_SOURCE_DIR
            "/assets/hand.glb -o hand.mdk -q; "
            "LD_LIBRARY_PATH=$(dirname \"$(find \"$PWD/second place\" -name libmdk.so.0)\") "
            "lidar/lidar hand.mdk cpp.ply");
  ASSERT_EQ(run.status, 0) << run.err;
  if (shell("test -d 'second place/lib/python3/dist-packages/mdk'").status != 0)
    GTEST_SKIP() << "the Python module was not built";
  const Outcome python = shell(
      "PYTHONPATH=\"$PWD/second place/lib/python3/dist-packages\" /usr/bin/python3 " MDK_SOURCE_DIR
      "/examples/lidar/lidar.py hand.mdk python.ply");
  ASSERT_EQ(python.status, 0) << python.err;
  EXPECT_TRUE(folder_->read("cpp.ply") == folder_->read("python.ply"));
}

TEST_F(Installed, EveryCommandHasAPageThatManTakesAndThatNamesItsOptions) {
  const std::string pages = "'second place/share/man/man1/'";
  EXPECT_THAT(shell("gzip -dc " + pages + "mdprep.1.gz").out, HasSubstr("mdprep\\-batch"));
  for (const char* command : {"bake", "info", "verify", "render", "bench", "batch", "job"}) {
    const std::string name = std::string("mdprep-") + command + ".1.gz";
    const std::string page = shell("gzip -dc " + pages + name).out;
    std::istringstream help(run_mdprep({command, "--help"}).out);
    for (std::string word; help >> word;) {
      if (word.rfind("--", 0) != 0) continue;
      std::string escaped;
      for (const char c : word.substr(0, word.find_first_of(",=.:;)")))
        escaped += c == '-' ? std::string("\\-") : std::string(1, c);
      EXPECT_THAT(page, HasSubstr(escaped)) << name;
    }
    if (!has_program("man")) continue;
    const Outcome man = shell("MANROFFOPT=-ww LC_ALL=C.UTF-8 man --warnings -l " + pages + name);
    EXPECT_EQ(man.status, 0);
    EXPECT_EQ(man.err, "") << name;
  }
}

TEST_F(Installed, TheViewersPageNamesItsOptions) {
  const Outcome help = shell("mdview --help");
  if (help.status != 0) GTEST_SKIP() << "mdview is not installed";
  const std::string page = shell("gzip -dc 'second place/share/man/man1/mdview.1.gz'").out;
  std::istringstream words(help.out);
  for (std::string word; words >> word;) {
    if (word.rfind("--", 0) != 0) continue;
    std::string escaped;
    for (const char c : word.substr(0, word.find_first_of(",)")))
      escaped += c == '-' ? std::string("\\-") : std::string(1, c);
    EXPECT_THAT(page, HasSubstr(escaped));
  }
}

/// What bash offers after these words, the last one being completed.
std::string offered(const BatchFolder& folder, const std::string& words) {
  return folder
      .shell(
          "bash -c 'source \"second place/share/bash-completion/completions/mdprep\"; "
          "COMP_WORDS=(" +
          words +
          "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _mdprep; "
          "printf \"%s \" \"${COMPREPLY[@]}\"'")
      .out;
}

TEST_F(Installed, BashCompletesCommandsOptionsAndTheirWords) {
  EXPECT_EQ(offered(*folder_, "mdprep b"), "bake bench batch ");
  EXPECT_THAT(offered(*folder_, "mdprep bake --mem"), "--memory-limit ");
  EXPECT_EQ(offered(*folder_, "mdprep bake --decompose \"\""), "motion bones none ");
  EXPECT_EQ(offered(*folder_, "mdprep bake --decompose = b"), "bones ");
  EXPECT_EQ(offered(*folder_, "mdprep bake x.glb --refine o"), "on off ");
  EXPECT_EQ(offered(*folder_, "mdprep batch --only r"), "render ");
  EXPECT_EQ(offered(*folder_, "mdprep bake x"), " ") << "names of files are bash's own";
  EXPECT_THAT(offered(*folder_, "mdprep --v"), "--version ");
}

}  // namespace
}  // namespace mdk::test
