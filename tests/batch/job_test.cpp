// mdprep job, started as an engine does: when it works, when it need not, and what it leaves
// behind.
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/file.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "preprocess/batch/job_record.h"
#include "tests/batch/batch_folder.h"
#include "tests/commands/sample_mesh.h"

namespace mdk::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class JobTest : public testing::Test {
 protected:
  void SetUp() override { folder_.write_source("a", 1); }

  std::string at(const std::string& name) const { return folder_.file(name); }

  Outcome job(const std::string& record, std::vector<std::string> command,
              std::vector<std::string> options = {}) const {
    options.insert(options.begin(), {"job", "--record", at(record)});
    options.emplace_back("--");
    options.insert(options.end(), command.begin(), command.end());
    return run_mdprep(options);
  }
  Outcome bake(std::vector<std::string> options = {}) const {
    options.insert(options.begin(), {"bake", at("a.gltf"), "-o", at("out/a.mdk"), "-q"});
    return job("r/a.json", options);
  }
  JobRecord record(const std::string& name) const {
    const auto read = read_job_record(at(name));
    return read ? *read : JobRecord{};
  }
  bool said_up_to_date(const Outcome& outcome) const {
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return outcome.err.find("up to date") != std::string::npos;
  }

  BatchFolder folder_;
};

TEST_F(JobTest, MakesItsFoldersAndTellsWhatCameOfIt) {
  const Outcome run = bake();
  ASSERT_EQ(run.status, 0) << run.err;
  const JobRecord done = record("r/a.json");
  EXPECT_EQ(done.status, JobStatus::kDone);
  std::vector<std::string> inputs;
  for (const FileState& input : done.inputs) inputs.push_back(input.path);
  EXPECT_THAT(inputs, ElementsAre(at("a.gltf"), at("a.bin"), at("a.png")));
  ASSERT_EQ(done.outputs.size(), 1u);
  EXPECT_EQ(done.outputs[0].bytes, std::filesystem::file_size(at("out/a.mdk")));
  EXPECT_GT(done.seconds, 0);
  EXPECT_GT(done.peak_memory_bytes, 1u << 20);
  EXPECT_EQ(nlohmann::json::parse(done.report)["triangles"], 4);
}

TEST_F(JobTest, ContentDecidesWhetherItRunsAgain) {
  ASSERT_FALSE(said_up_to_date(bake()));
  EXPECT_TRUE(said_up_to_date(bake()));
  EXPECT_TRUE(said_up_to_date(bake({"--threads", "2", "--memory-limit", "1G"})));
  EXPECT_TRUE(said_up_to_date(bake({"--fps", "30.0"}))) << "the default, spelt out";
  folder_.shell("touch a.gltf a.bin a.png out/a.mdk");
  EXPECT_TRUE(said_up_to_date(bake())) << "touched, but the same";

  folder_.write("a.png", folder_.read("a.png") + " ");
  EXPECT_FALSE(said_up_to_date(bake())) << "a texture changed";
  EXPECT_TRUE(said_up_to_date(bake()));
  EXPECT_FALSE(said_up_to_date(bake({"--fps", "10"}))) << "an option changed";
  EXPECT_FALSE(said_up_to_date(bake()));
  folder_.write("out/a.mdk", "damaged");
  EXPECT_FALSE(said_up_to_date(bake())) << "the output changed";
  std::filesystem::remove(at("out/a.mdk"));
  EXPECT_FALSE(said_up_to_date(bake())) << "the output is gone";
  std::string text = folder_.read("r/a.json");
  const std::size_t hash = text.find("\"program_hash\": \"") + 17;
  text[hash] = text[hash] == '0' ? '1' : '0';
  folder_.write("r/a.json", text);
  EXPECT_FALSE(said_up_to_date(bake())) << "another program made it";
  folder_.write("r/a.json", text.substr(0, text.size() / 2));
  EXPECT_FALSE(said_up_to_date(bake())) << "the record is cut";
}

TEST_F(JobTest, AnImageThatWasMissingAndAppearsIsAChange) {
  const std::string image = folder_.read("a.png");
  std::filesystem::remove(at("a.png"));
  ASSERT_FALSE(said_up_to_date(bake()));
  EXPECT_THAT(record("r/a.json").unread, ElementsAre(at("a.png")));
  const std::string plain = folder_.read("out/a.mdk");
  EXPECT_TRUE(said_up_to_date(bake()));
  std::filesystem::create_directory(at("a.png"));
  EXPECT_TRUE(said_up_to_date(bake())) << "a folder is no image";
  std::filesystem::remove(at("a.png"));
  folder_.write("a.png", image);
  EXPECT_FALSE(said_up_to_date(bake()));
  EXPECT_FALSE(folder_.read("out/a.mdk") == plain);
  EXPECT_TRUE(record("r/a.json").unread.empty());
}

TEST_F(JobTest, TheDepfileNamesTheFolderWhereAMissingImageWouldAppear) {
  std::filesystem::remove(at("a.png"));
  ASSERT_EQ(job("r/a.json", {"bake", at("a.gltf"), "-o", at("out/a.mdk"), "-q"},
                {"--depfile", at("r/a.d")})
                .status,
            0);
  EXPECT_THAT(folder_.read("r/a.d"), testing::EndsWith(" \\\n  " + folder_.path() + "\n"));
}

TEST_F(JobTest, ANewFrameOfANumberedSequenceIsAChange) {
  const auto frame = [&](int number, int height) {
    std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 ";
    text += std::to_string(height);
    text += "\nf 1 2 3\n";
    folder_.write("walk/f_" + std::to_string(number) + ".obj", text);
  };
  const auto walk = [&] {
    return job("r/walk.json", {"bake", at("walk/f_#.obj"), "-o", at("out/walk.mdk"), "-q"});
  };
  frame(1, 0);
  frame(2, 1);
  ASSERT_FALSE(said_up_to_date(walk()));
  EXPECT_TRUE(said_up_to_date(walk()));
  frame(3, 2);
  EXPECT_FALSE(said_up_to_date(walk()));
  EXPECT_EQ(nlohmann::json::parse(record("r/walk.json").report)["keys"], 3);
}

TEST_F(JobTest, AnOutputThatComesOutAsItWasKeepsItsTimeStamp) {
  ASSERT_EQ(bake().status, 0);
  const long long before = folder_.time_stamp("out/a.mdk");
  folder_.write("a.gltf", folder_.read("a.gltf") + "\n");
  ASSERT_FALSE(said_up_to_date(bake()));
  EXPECT_EQ(folder_.time_stamp("out/a.mdk"), before);
}

TEST_F(JobTest, FailuresAreKeptWithTheirReason) {
  folder_.write("bad.glb", "This is no glTF.");
  const Outcome run = job("r/bad.json", {"bake", at("bad.glb"), "-o", at("out/bad.mdk")});
  EXPECT_EQ(run.status, 3);
  const JobRecord failed = record("r/bad.json");
  EXPECT_EQ(failed.status, JobStatus::kFailed);
  EXPECT_EQ(failed.exit_status, 3);
  EXPECT_THAT(run.err, HasSubstr(failed.reason));
  EXPECT_THAT(failed.reason, HasSubstr("bad.glb"));
  EXPECT_EQ(bake({"--memory-limit", "5M"}).status, 5);
  EXPECT_EQ(record("r/a.json").status, JobStatus::kFailed);
  EXPECT_EQ(bake().status, 0);
}

TEST_F(JobTest, RunsOnlyAfterWhatItNeedsSucceeded) {
  const std::vector<std::string> render = {
      "render", at("out/a.mdk"), "-o", at("f/#.png"), "--size", "16x16", "--frames", "0:3", "-q"};
  const auto needy = [&] { return job("r/f.json", render, {"--needs", at("r/a.json")}); };
  EXPECT_EQ(needy().status, 3);
  EXPECT_EQ(record("r/f.json").status, JobStatus::kBlocked);
  ASSERT_EQ(bake().status, 0);
  EXPECT_EQ(needy().status, 0);
  EXPECT_EQ(record("r/f.json").outputs.size(), 4u);
  EXPECT_TRUE(said_up_to_date(needy()));
  folder_.write("a.gltf", "{");
  EXPECT_EQ(bake().status, 3);
  EXPECT_EQ(needy().status, 3) << "what is there is stale";
}

TEST_F(JobTest, WrongUseIsStatus2) {
  EXPECT_EQ(job("r.json", {"info", at("out/a.mdk")}).status, 2);
  EXPECT_EQ(job("r.json", {"bake"}).status, 2);
  EXPECT_EQ(run_mdprep({"job", "--record", at("r.json")}).status, 2);
  EXPECT_FALSE(folder_.has("r.json"));
}

TEST_F(JobTest, NeedsNoHomeNoDisplayAndNoNetwork) {
  const std::string line = "env -i " MDPREP_PATH " job --record=r.json -- bake a.gltf -o a.mdk -q";
  const bool can_unshare = folder_.shell("unshare -n true").status == 0;
  const Outcome run = folder_.shell((can_unshare ? "unshare -n " : "") + line);
  EXPECT_EQ(run.status, 0) << run.err;
}

/// A bake that takes a while, and its record.
class LongJob : public JobTest {
 protected:
  void SetUp() override { write_sample_gltf(at("long.gltf"), {400, 64}); }

  std::vector<std::string> words() const {
    return {"job", "--record",         at("long.json"), "--",    "bake",     at("long.gltf"),
            "-o",  at("out/long.mdk"), "--progress",    "plain", "--refine", "off"};
  }
  /// Waits until the bake itself runs.
  static void wait_for_progress(const ProgramRun& run) {
    for (int i = 0; i < 3000 && run.err_so_far().empty(); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
};

TEST_F(LongJob, StoppedBySigtermItSaysSoAndLeavesNothing) {
  ProgramRun run(words());
  wait_for_progress(run);
  run.send_signal(SIGTERM);
  EXPECT_EQ(run.wait().status, 143);
  EXPECT_EQ(record("long.json").status, JobStatus::kStopped);
  EXPECT_EQ(record("long.json").exit_status, 143);
  EXPECT_TRUE(std::filesystem::is_empty(at("out")));
}

TEST_F(LongJob, KilledAndRunAgainItMakesTheSameBytes) {
  ProgramRun killed(words());
  wait_for_progress(killed);
  killed.send_signal(SIGKILL);
  EXPECT_EQ(killed.wait().status, 1000 + SIGKILL);
  EXPECT_EQ(record("long.json").status, JobStatus::kStarted);
  folder_.write("out/.long.mdk.tmp-1-0", "half a file, from a writer that is gone");

  ASSERT_EQ(run_mdprep(words()).status, 0);
  EXPECT_FALSE(folder_.has("out/.long.mdk.tmp-1-0"));
  const std::string again = folder_.read("out/long.mdk");
  ASSERT_EQ(run_mdprep({"job", "--record", at("other.json"), "--", "bake", at("long.gltf"), "-o",
                        at("out/other.mdk"), "-q", "--refine", "off"})
                .status,
            0);
  EXPECT_TRUE(again == folder_.read("out/other.mdk"));
}

TEST_F(JobTest, ManyJobsMayShareAFolderAndEvenAnOutput) {
  std::string line;
  for (int i = 0; i < 8; ++i) {
    const std::string n = std::to_string(i / 2);  // two of each
    folder_.write_source("s" + n, i / 2);
    line +=
        MDPREP_PATH " job --record=r" + n + ".json -- bake s" + n + ".gltf -o o" + n + ".mdk -q & ";
  }
  ASSERT_EQ(folder_.shell(line + "wait").status, 0);
  for (int i = 0; i < 4; ++i) {
    const std::string n = std::to_string(i);
    ASSERT_EQ(folder_.shell(MDPREP_PATH " bake s" + n + ".gltf -o alone.mdk -q").status, 0);
    EXPECT_TRUE(folder_.read("o" + n + ".mdk") == folder_.read("alone.mdk"));
    EXPECT_EQ(record("r" + n + ".json").status, JobStatus::kDone);
  }
  EXPECT_EQ(folder_.shell("ls -A | grep tmp").out, "");
}

}  // namespace
}  // namespace mdk::test
