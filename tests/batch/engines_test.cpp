// The real engines, on two dozen bakes and the renders that hang on them. Runs where MDK_TEST_FARM
// is set (./run test --farm); an engine that is not there is skipped by name.
#include <gmock/gmock.h>
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "preprocess/batch/job_record.h"
#include "tests/batch/batch_folder.h"
#include "tests/batch/slurm_cluster.h"
#include "tests/commands/sample_mesh.h"

namespace mdk::test {
namespace {

using testing::HasSubstr;
using Json = nlohmann::json;

constexpr int kBakes = 24;
constexpr int kRangesPerRender = 2;

constexpr const char* kManifest = R"({
  "defaults": {"bake": {"memory": "256M"}, "render": {"memory": "256M", "options": {"size": "24x24"}}},
  "bakes": [{"input": "in/*.gltf", "output": "out/{stem}.mdk"}],
  "renders": [{"input": "out/*.mdk", "output": "frames/{stem}_##.png", "frames": "0:10",
               "frames_per_job": 6}]
})";

class Engines : public testing::Test {
 protected:
  void SetUp() override {
    if (std::getenv("MDK_TEST_FARM") == nullptr)
      GTEST_SKIP() << "takes minutes; ./run test --farm runs it";
    for (int i = 0; i < kBakes; ++i) folder_.write_source("in/" + name(i), i);
    folder_.write_manifest(kManifest);
  }

  static std::string name(int i) { return (i < 10 ? "s0" : "s") + std::to_string(i); }

  void need(const std::string& program) {
    if (!has_program(program)) GTEST_SKIP() << "there is no " << program;
  }

  /// What plain shell, one job after another, makes of the same manifest elsewhere.
  static std::vector<std::string> expected(const BatchFolder& folder) {
    const Outcome list = folder.batch({"--list"});
    EXPECT_EQ(list.status, 0) << list.err;
    BatchFolder plain;
    plain.write("jobs.sh", list.out);
    plain.shell("cp -r '" + folder.path() + "/in' . && bash jobs.sh");
    return made(plain);
  }
  static std::vector<std::string> made(const BatchFolder& folder) {
    std::vector<std::string> files = folder.made_files("out");
    const std::vector<std::string> frames = folder.made_files("frames");
    files.insert(files.end(), frames.begin(), frames.end());
    return files;
  }

  Json summary(int status) const {
    const Outcome run = folder_.batch({"--summary", "--json", folder_.file("summary.json"),
                                       "--html", folder_.file("summary.html")});
    EXPECT_EQ(run.status, status) << run.out << run.err;
    return Json::parse(folder_.read("summary.json"));
  }
  void expect_all_done() const {
    const Json merged = summary(0);
    EXPECT_EQ(merged["totals"]["jobs"], kBakes * (1 + kRangesPerRender));
    EXPECT_EQ(merged["totals"]["done"], merged["totals"]["jobs"]);
    EXPECT_TRUE(made(folder_) == expected(folder_));
  }

  /// Time stamps of what bakes and renders made.
  std::string stamps() const {
    return folder_.shell("find out frames -type f -printf '%p %T@\n'").out;
  }

  BatchFolder folder_;
};

TEST_F(Engines, NinjaDoesWhatChangedAndNothingElse) {
  need("ninja");
  if (IsSkipped()) return;
  ASSERT_EQ(folder_.batch({"--ninja", folder_.file("build.ninja")}).status, 0);
  const auto ninja = [&] {
    const Outcome run = folder_.shell("ninja");
    EXPECT_EQ(run.status, 0) << run.out << run.err;
    return std::count(run.out.begin(), run.out.end(), ']');  // "[3/72] bake …"
  };
  EXPECT_EQ(ninja(), kBakes * (1 + kRangesPerRender));
  expect_all_done();
  EXPECT_EQ(ninja(), 0);

  const std::string before = stamps();
  folder_.shell("touch in/s03.png");
  EXPECT_EQ(ninja(), 1) << "one bake is asked, no render";
  EXPECT_EQ(stamps(), before);
  EXPECT_EQ(ninja(), 0);

  const long long other = folder_.time_stamp("out/s04.mdk");
  folder_.shell("cp in/s09.png in/s03.png");
  EXPECT_EQ(ninja(), 1 + kRangesPerRender);
  EXPECT_EQ(folder_.time_stamp("out/s04.mdk"), other);
  EXPECT_EQ(ninja(), 0);

  std::string changed = kManifest;
  changed.replace(changed.find("24x24"), 5, "20x20");
  folder_.write_manifest(changed);
  ASSERT_EQ(folder_.batch({"--ninja", folder_.file("build.ninja")}).status, 0);
  const long long baked = folder_.time_stamp("out/s04.mdk");
  EXPECT_EQ(ninja(), kBakes * kRangesPerRender) << "only renders have another option";
  EXPECT_EQ(folder_.time_stamp("out/s04.mdk"), baked);
  expect_all_done();
  EXPECT_EQ(ninja(), 0);
}

TEST_F(Engines, MakeDoesTheSameFromTheSameDepfiles) {
  need("make");
  if (IsSkipped()) return;
  ASSERT_EQ(folder_.batch({"--make", folder_.file("Makefile")}).status, 0);
  const auto make = [&] {
    const Outcome run = folder_.shell("make -j2 --trace");
    EXPECT_EQ(run.status, 0) << run.out << run.err;
    int asked = 0;
    for (std::size_t at = run.out.find(" job --record"); at != std::string::npos;
         at = run.out.find(" job --record", at + 1))
      ++asked;
    return asked;
  };
  EXPECT_EQ(make(), kBakes * (1 + kRangesPerRender));
  expect_all_done();
  EXPECT_EQ(make(), 0);

  const std::string before = stamps();
  folder_.shell("touch in/s03.png");
  EXPECT_EQ(make(), 1);
  EXPECT_EQ(stamps(), before);
  folder_.shell("cp in/s09.png in/s03.png");
  EXPECT_EQ(make(), 1 + kRangesPerRender);
  folder_.shell("rm out/s05.mdk frames/s06_02.png");
  const long long rendered = folder_.time_stamp("frames/s05_00.png");
  EXPECT_EQ(make(), 2 + kRangesPerRender) << "its renders are asked, since the bake's file is new";
  EXPECT_EQ(folder_.time_stamp("frames/s05_00.png"), rendered) << "and have nothing to do";
  EXPECT_EQ(make(), 0);
}

TEST_F(Engines, ParallelRunsTheList) {
  need("parallel");
  if (IsSkipped()) return;
  const std::string list = MDPREP_PATH " batch batch.json --list --only ";
  const std::string run = list + "bake | parallel -j2 && " + list + "render | parallel -j2";
  const Outcome first = folder_.shell(run);
  EXPECT_EQ(first.status, 0) << first.err;
  expect_all_done();
  const std::string before = stamps();
  EXPECT_EQ(folder_.shell(run).status, 0);
  EXPECT_EQ(stamps(), before) << "a second run does nothing";
}

TEST_F(Engines, SlurmArraysSurviveAKilledTaskAndNameABadInput) {
  const SlurmCluster cluster;
  if (!cluster.trouble().empty()) GTEST_SKIP() << "no Slurm here: " << cluster.trouble();
  folder_.write("in/" + name(7) + ".gltf", "This is no glTF.");
  write_sample_gltf(folder_.file("in/" + name(12) + ".gltf"), {200, 64});
  ASSERT_EQ(folder_.batch({"--slurm", folder_.file("farm.sh")}).status, 0);
  const std::string submit = cluster.environment() + " bash farm.sh --wait";

  const std::string victim = folder_.file("records/out/" + name(12) + ".mdk.json");
  std::thread killer([&] {
    for (int i = 0; i < 1200; ++i, std::this_thread::sleep_for(std::chrono::milliseconds(50))) {
      const auto record = read_job_record(victim);
      if (!record || record->status != JobStatus::kStarted) continue;
      std::this_thread::sleep_for(std::chrono::milliseconds(300));
      kill(static_cast<pid_t>(record->process), SIGKILL);
      return;
    }
  });
  const Outcome first = folder_.shell(submit);
  killer.join();
  EXPECT_EQ(first.status, 3) << first.out << first.err;
  EXPECT_THAT(first.out, HasSubstr("was killed without a word"));
  std::set<std::string> not_done;
  const Json merged_first = summary(3);
  for (const Json& job : merged_first["not_done"]) not_done.insert(job["record"]);
  EXPECT_EQ(not_done.size(), 2u * (1 + kRangesPerRender)) << "the bad, the killed, their renders";

  const std::string before = folder_.shell("find out -type f -printf '%p %T@\n' | sort").out;
  const Outcome second = folder_.shell(submit);
  EXPECT_EQ(second.status, 3) << second.out << second.err;
  EXPECT_THAT(second.out, HasSubstr("in/" + name(7) + ".gltf"));
  EXPECT_THAT(second.out, testing::Not(HasSubstr(name(12) + ".mdk.json  it runs")));
  EXPECT_THAT(folder_.shell("find out -type f -printf '%p %T@\n' | sort").out,
              testing::SizeIs(testing::Gt(before.size())));
  const Json merged = summary(3);
  EXPECT_EQ(merged["not_done"].size(), 1u + kRangesPerRender);
  EXPECT_EQ(merged["not_done"][0]["status"], "failed");
  EXPECT_EQ(merged["not_done"][1]["status"], "blocked");
  EXPECT_TRUE(made(folder_) == expected(folder_)) << "all else is whole";
  EXPECT_FALSE(folder_.shell("ls records/slurm").out.empty()) << "a log for each task";
}

}  // namespace
}  // namespace mdk::test
