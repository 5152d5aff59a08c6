// What is written for engines, as text.
#include "preprocess/batch/engine_files.h"

#include <gmock/gmock.h>

#include "common/base/error.h"
#include "tests/batch/batch_folder.h"

namespace mdk::test {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr std::uint64_t kGibibyte = std::uint64_t{1} << 30;

Job job_of(JobKind kind, const std::string& output, std::uint64_t memory) {
  Job job;
  job.kind = kind;
  job.command = {kind_name(kind), "in/a b.glb", "-o", output};
  job.inputs = {"in/a b.glb"};
  job.outputs = {output};
  job.record = "r/" + output + ".json";
  job.memory_bytes = memory;
  return job;
}

class EngineFiles : public testing::Test {
 protected:
  EngineFiles() {
    jobs_ = {job_of(JobKind::kBake, "a.mdk", kGibibyte), job_of(JobKind::kBake, "b.mdk", kGibibyte),
             job_of(JobKind::kRender, "a.png", kGibibyte)};
    jobs_[2].needs = {0};
    options_.manifest = "m.json";
    options_.folder = "/farm/it's here";
    options_.records = "r";
    options_.cores = 8;
    options_.memory_bytes = 16 * kGibibyte;
  }

  std::vector<Job> jobs_;
  EngineOptions options_;
};

TEST_F(EngineFiles, ALineHasAllAJobNeeds) {
  const JobKind kinds[] = {JobKind::kRender};
  EXPECT_EQ(job_list_text(jobs_, kinds, options_),
            "mdprep job --record=r/a.png.json --depfile=r/a.png.json.d --needs=r/a.mdk.json -q -- "
            "render 'in/a b.glb' -o a.png --threads=1 --memory-limit=1024M -q\n");
}

TEST_F(EngineFiles, NinjaQuotesNamesAndKnowsEveryFile) {
  const std::string text = ninja_text(jobs_, options_);
  EXPECT_THAT(text, HasSubstr("build a.mdk | r/a.mdk.json: bake in/a$ b.glb | $mdprep\n"));
  EXPECT_THAT(text, HasSubstr("restat = 1"));
  EXPECT_THAT(text, HasSubstr("depfile = $record.d\n  deps = gcc"));
}

TEST_F(EngineFiles, NinjasPoolsKeepWithinCoresAndMemory) {
  const auto depths = [&] {
    const std::string text = ninja_text(jobs_, options_);
    const auto depth = [&](const std::string& pool) {
      const std::string before = "pool " + pool + "\n  depth = ";
      return std::stoi(text.substr(text.find(before) + before.size()));
    };
    return std::pair(depth("light"), depth("heavy"));
  };
  EXPECT_EQ(depths().first, 8) << "8 x 1 GiB fit into 16";
  jobs_[1].memory_bytes = 3 * kGibibyte;
  EXPECT_EQ(depths(), std::pair(8, 2)) << "8 x 1 light leave 8: two of 3";
  jobs_[1].threads = 8;
  EXPECT_EQ(depths(), std::pair(8, 1));
  jobs_[1].memory_bytes = 17 * kGibibyte;
  EXPECT_THROW(ninja_text(jobs_, options_), Error);
}

TEST_F(EngineFiles, SlurmGetsAnArrayForEachSetOfLimits) {
  jobs_[1].threads = 4;
  jobs_[1].minutes = 20;
  const std::string text = slurm_text(jobs_, options_);
  EXPECT_THAT(text, HasSubstr("3 jobs in 3 arrays"));
  EXPECT_THAT(text, HasSubstr("cd '/farm/it'\\''s here'\n"));
  EXPECT_THAT(text, HasSubstr("--cpus-per-task=4 --mem=1024M --time=20"));
  EXPECT_THAT(text, HasSubstr("--job-name=mdprep-render --array=0-0 --cpus-per-task=1 --mem=1024M "
                              "--dependency=afterany:$array0 --requeue"))
      << "on the array of its own bake alone";
  EXPECT_THAT(text, HasSubstr("--dependency=afterany:$array0:$array1:$array2 "));
  EXPECT_THAT(text, HasSubstr("--progress=plain"));
}

TEST_F(EngineFiles, SlurmsArraysStayBelowItsLimit) {
  jobs_.assign(2500, jobs_[0]);
  for (std::size_t i = 0; i < jobs_.size(); ++i) jobs_[i].record = std::to_string(i);
  const std::string text = slurm_text(jobs_, options_);
  EXPECT_THAT(text, HasSubstr("2500 jobs in 3 arrays"));
  EXPECT_THAT(text, HasSubstr("--array=0-999 "));
  EXPECT_THAT(text, HasSubstr("--array=0-499 "));
  EXPECT_THAT(text, Not(HasSubstr("--array=0-1000")));
}

TEST_F(EngineFiles, MakeRefusesNamesItCannotHold) {
  EXPECT_THAT(make_text(jobs_, options_), HasSubstr("r/a.mdk.json: in/a\\ b.glb $(MDPREP)"));
  jobs_[0].outputs = {"a:b.mdk"};
  EXPECT_THROW(make_text(jobs_, options_), Error);
}

TEST(Quoting, AShellGivesEveryWordBackAsItWas) {
  const std::vector<std::string> words = {
      "plain", "",    "two words", "it's", "$HOME `id` $(id)", "a\\b",  "*?[a]", "~",
      "\"q\"", "a#b", "-n",        "!x",   "a;b&c|d",          "{a,b}", "ü=λ"};
  std::string expected;
  for (const std::string& word : words) expected += "<" + word + ">";
  const BatchFolder folder;
  EXPECT_EQ(folder.shell("printf '<%s>' " + shell_line(words)).out, expected);
}

TEST(Quoting, NinjaAndMakeDoubleTheirDollar) {
  EXPECT_EQ(ninja_path("a b:$c"), "a$ b$:$$c");
  EXPECT_EQ(make_path("a b#$c%"), "a\\ b\\#$$c\\%");
  EXPECT_THROW(make_path("a:b"), Error);
}

}  // namespace
}  // namespace mdk::test
