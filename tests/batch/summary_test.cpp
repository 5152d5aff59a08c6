// Records of many jobs, merged.
#include "preprocess/batch/summary.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/batch/batch_folder.h"

namespace mdk::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using Json = nlohmann::json;

class Summary : public testing::Test {
 protected:
  Summary() {
    for (int i = 0; i < 6; ++i) {
      Job job;
      job.record = "r/job" + std::to_string(i) + ".json";
      job.place = "/bakes/" + std::to_string(i);
      jobs_.push_back(job);
    }
    // seconds 0, 1, 2; memory 30, 20, 10; files 5, 50, 7
    done(0, 0, 30, 5);
    done(1, 1, 20, 50);
    done(2, 2, 10, 7);
    JobRecord failed;
    failed.status = JobStatus::kFailed;
    failed.exit_status = 3;
    failed.reason = "in/<bad>.glb: is & stays \"no\" glTF";
    folder_.write(jobs_[3].record, job_record_json(failed));
    JobRecord killed;
    killed.host = "node7";
    killed.process = 4711;
    folder_.write(jobs_[4].record, job_record_json(killed));
    summary_ = summarize(jobs_, folder_.path());
  }
  void done(int i, double seconds, std::uint64_t memory, std::uint64_t bytes) {
    JobRecord record;
    record.status = JobStatus::kDone;
    record.seconds = seconds;
    record.peak_memory_bytes = memory;
    record.outputs = {{"a", bytes, 1}};
    folder_.write(jobs_[i].record, job_record_json(record));
  }

  BatchFolder folder_;
  std::vector<Job> jobs_;
  BatchSummary summary_;
};

TEST_F(Summary, OrdersWhatIsDoneAndNamesWhatIsNot) {
  EXPECT_THAT(summary_.slowest(9), ElementsAre(2, 1, 0));
  EXPECT_THAT(summary_.hungriest(2), ElementsAre(0, 1));
  EXPECT_THAT(summary_.largest(9), ElementsAre(1, 2, 0));
  EXPECT_THAT(summary_.failed(), ElementsAre(3, 4, 5));
  EXPECT_EQ(summary_.totals.done, 3u);
  EXPECT_EQ(summary_.totals.seconds, 3);
  EXPECT_EQ(summary_.totals.output_bytes, 62u);
  EXPECT_EQ(summary_.totals.peak_memory_bytes, 30u);
}

TEST_F(Summary, TheTableSaysWhyEachIsNotDone) {
  std::ostringstream out;
  print_summary(summary_, out);
  EXPECT_THAT(out.str(), HasSubstr("3 of 6 jobs done"));
  EXPECT_THAT(out.str(), HasSubstr("in/<bad>.glb: is & stays \"no\" glTF"));
  EXPECT_THAT(out.str(), HasSubstr("killed without a word (process 4711 on node7)"));
  EXPECT_THAT(out.str(), HasSubstr("missing   r/job5.json"));
}

TEST_F(Summary, JsonHasTheSame) {
  const Json json = Json::parse(summary_json(summary_));
  EXPECT_EQ(json["schema"], "mdprep-batch/1");
  EXPECT_EQ(json["totals"]["not_done"], 3);
  EXPECT_EQ(json["not_done"][0]["exit_status"], 3);
  EXPECT_EQ(json["not_done"][1]["status"], "started");
  EXPECT_EQ(json["not_done"][2]["status"], "missing");
  EXPECT_EQ(json["slowest"][0]["record"], "r/job2.json");
  EXPECT_EQ(json["largest"][0]["output_bytes"], 50);
}

TEST_F(Summary, ThePageNeedsNothingElseAndNamesCannotBreakIt) {
  const std::string html = summary_html(summary_, "a <b> & \"c\"");
  EXPECT_THAT(html, HasSubstr("in/&lt;bad&gt;.glb: is &amp; stays &quot;no&quot; glTF"));
  EXPECT_THAT(html, HasSubstr("<h1>a &lt;b&gt; &amp; &quot;c&quot;</h1>"));
  for (const char* word : {"http", "src=", "<link", "<script", "url("})
    EXPECT_THAT(html, testing::Not(HasSubstr(word)));
}

TEST_F(Summary, ARecordSurvivesTheRoundTrip) {
  JobRecord record;
  record.status = JobStatus::kStopped;
  record.command = {"bake", "two words", "ü"};
  record.version = "1.2.3";
  record.program_hash = 0xfedcba9876543210u;
  record.command_hash = 1;
  record.host = "h";
  record.process = 12;
  record.task = "4711_3";
  record.exit_status = 143;
  record.reason = "interrupted";
  record.seconds = 0.1;
  record.peak_memory_bytes = 1ull << 40;
  record.inputs = {{"a", 1, 2}, {"b", 3, 4}};
  record.outputs = {{"c", 5, 6}};
  record.report = R"({"x":1})";
  folder_.write("r.json", job_record_json(record));
  const auto back = read_job_record(folder_.file("r.json"));
  ASSERT_TRUE(back.has_value());
  EXPECT_EQ(job_record_json(*back), job_record_json(record));
  EXPECT_EQ(back->program_hash, record.program_hash);
  EXPECT_EQ(back->inputs, record.inputs);
  const std::string whole = folder_.read("r.json");
  for (std::size_t size = 0; size + 2 < whole.size(); size += 7) {
    folder_.write("cut.json", whole.substr(0, size));
    EXPECT_FALSE(read_job_record(folder_.file("cut.json"))) << size;
  }
}

}  // namespace
}  // namespace mdk::test
