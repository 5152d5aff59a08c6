// Every sample that is at hand, whatever its format, through two engines: the same bytes from both,
// and nothing to do a second time. Runs where MDK_TEST_FARM is set (./run test --farm).
#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/batch/batch_folder.h"
#include "tests/batch/slurm_cluster.h"
#include "tests/formats/sample_data.h"

namespace mdk::test {
namespace {

// Few keys a second: what is read counts here, not how long it moves.
constexpr const char* kManifest = R"({
  "defaults": {"bake": {"memory": "1G", "options": {"fps": 10}},
               "render": {"memory": "1G", "options": {"size": "64x48"}}},
  "bakes": [
    {"input": "data/**/*.gltf", "output": "out/{folder}/{stem}.mdk"},
    {"input": "data/**/*.glb", "output": "out/{folder}/{stem}.mdk"},
    {"input": ["data/sequences/*.obj", "data/sequences/{stem}.pc2"], "output": "out/sequences/{stem}_pc2.mdk"},
    {"input": ["data/sequences/cat_poses.obj", "data/sequences/cat_poses.mdd"], "output": "out/sequences/cat_mdd.mdk"},
    {"input": "data/sequences/cow_obj/#.obj", "output": "out/sequences/cow_obj.mdk"}
  ],
  "renders": [{"input": "out/**/*.mdk", "output": "frames/{folder}/{stem}_#.png", "frames": "0:0"}]
})";

class EnginesOnEverySample : public SampleData {
 protected:
  void SetUp() override {
    if (std::getenv("MDK_TEST_FARM") == nullptr)
      GTEST_SKIP() << "takes minutes; ./run test --farm runs it";
    SampleData::SetUp();
  }

  /// Samples, a source of our own with a texture beside it, and the manifest.
  void fill(const BatchFolder& folder) const {
    ASSERT_EQ(folder.shell("cp -r '" + folder_.string() + "' data").status, 0);
    folder.write_source("data/own", 1);
    folder.write_manifest(kManifest);
  }
  /// Names and content of all that was made.
  static std::string made(const BatchFolder& folder) {
    return folder.shell("find out frames -type f | sort | xargs -d '\\n' sha256sum").out;
  }
  static std::string stamps(const BatchFolder& folder) {
    return folder.shell("find out frames -type f -printf '%p %T@\\n' | sort").out;
  }
  static void run(const BatchFolder& folder, const std::string& line) {
    const Outcome outcome = folder.shell(line);
    ASSERT_EQ(outcome.status, 0) << outcome.out << outcome.err;
  }
};

TEST_F(EnginesOnEverySample, NinjaAndSlurmMakeTheSameBytesAndASecondRunNothing) {
  if (!has_program("ninja")) GTEST_SKIP() << "there is no ninja";
  const BatchFolder by_ninja;
  fill(by_ninja);
  ASSERT_EQ(by_ninja.batch({"--ninja", by_ninja.file("build.ninja")}).status, 0);
  run(by_ninja, "ninja");
  EXPECT_GT(by_ninja.made_files("out").size(), 60u);
  const std::string expected = made(by_ninja);
  EXPECT_EQ(by_ninja.shell("ninja").out, "ninja: no work to do.\n");

  run(by_ninja, "cp frames/khronos/Fox_0.png data/own.png && ninja bakes");
  EXPECT_EQ(by_ninja.shell("find out -type f -newer data/own.png").out, "out/own.mdk\n");

  const SlurmCluster cluster;
  if (!cluster.trouble().empty()) GTEST_SKIP() << "no Slurm here: " << cluster.trouble();
  const BatchFolder by_slurm;
  fill(by_slurm);
  ASSERT_EQ(by_slurm.batch({"--slurm", by_slurm.file("farm.sh")}).status, 0);
  const std::string submit = cluster.environment() + " bash farm.sh --wait";
  run(by_slurm, submit);
  EXPECT_EQ(made(by_slurm), expected);
  const std::string first = stamps(by_slurm);
  run(by_slurm, submit);
  EXPECT_EQ(stamps(by_slurm), first);
}

}  // namespace
}  // namespace mdk::test
