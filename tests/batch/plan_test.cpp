// From a manifest to jobs: what is planned, and how mistakes are told.
#include "preprocess/batch/plan.h"

#include <gmock/gmock.h>

#include "common/base/error.h"
#include "tests/batch/batch_folder.h"

namespace mdk::test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

class Plan : public testing::Test {
 protected:
  std::vector<Job> plan(const std::string& json) {
    folder_.write_manifest(json);
    return folder_.plan();
  }
  /// The sentence of a manifest that is refused.
  std::string refusal(const std::string& json) {
    try {
      plan(json);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kBadInput) << json;
      return error.what();
    }
    ADD_FAILURE() << "was taken: " << json;
    return "";
  }

  BatchFolder folder_;
};

TEST_F(Plan, BakesAreWhatPatternsNameWithDefaultsFilledIn) {
  for (const char* name : {"in/b.glb", "in/a.glb", "in/c.glb"}) folder_.write(name, "");
  const std::vector<Job> jobs = plan(R"({
    "defaults": {"bake": {"memory": "512M", "threads": 2, "options": {"fps": 24, "stop": 5}}},
    "bakes": [{"input": "in/*.glb", "exclude": "in/c*", "output": "out/{stem}.mdk",
               "minutes": 30, "options": {"stop": null, "refine": "off"}}]})");
  ASSERT_EQ(jobs.size(), 2u);
  EXPECT_THAT(jobs[0].command,
              ElementsAre("bake", "in/a.glb", "-o", "out/a.mdk", "--fps=24", "--refine=off"));
  EXPECT_THAT(jobs[1].outputs, ElementsAre("out/b.mdk"));
  EXPECT_EQ(jobs[1].record, "records/out/b.mdk.json");
  EXPECT_EQ(jobs[1].memory_bytes, 512u << 20);
  EXPECT_EQ(jobs[1].threads, 2u);
  EXPECT_EQ(jobs[1].minutes, 30u);
}

TEST_F(Plan, AMeshTakesTheCacheOfItsName) {
  folder_.write("in/cow.obj", "");
  const std::vector<Job> jobs =
      plan(R"({"bakes": [{"input": ["in/*.obj", "in/{stem}.pc2"], "output": "{stem}.mdk"}]})");
  EXPECT_THAT(jobs[0].inputs, ElementsAre("in/cow.obj", "in/cow.pc2"));
}

TEST_F(Plan, ANumberedSequenceHangsOnItsFolder) {
  const std::vector<Job> jobs =
      plan(R"({"bakes": [{"input": "in/walk_####.obj", "output": "walk.mdk"}]})");
  EXPECT_THAT(jobs[0].command, ElementsAre("bake", "in/walk_####.obj", "-o", "walk.mdk"));
  EXPECT_THAT(jobs[0].inputs, ElementsAre("in"));
}

TEST_F(Plan, LongSequencesAreCutAndEveryFrameIsKnown) {
  const std::vector<Job> jobs = plan(R"({
    "bakes": [{"input": "a.glb", "output": "a.mdk"}],
    "renders": [{"input": "*.mdk", "output": "f/{stem}_###.png", "frames": "0:20:2",
                 "frames_per_job": 4, "options": {"size": "64x64"}}]})");
  ASSERT_EQ(jobs.size(), 4u);
  EXPECT_THAT(jobs[1].command, ElementsAre("render", "a.mdk", "-o", "f/a_###.png", "--frames=0:6:2",
                                           "--size=64x64"));
  EXPECT_THAT(jobs[3].command, testing::Contains("--frames=16:20:2"));
  EXPECT_THAT(jobs[3].outputs, ElementsAre("f/a_016.png", "f/a_018.png", "f/a_020.png"));
  EXPECT_EQ(jobs[3].record, "records/f/a_16-20.png.json");
  for (int i = 1; i < 4; ++i) EXPECT_THAT(jobs[i].needs, ElementsAre(0u));
}

TEST_F(Plan, ARenderWithoutFramesIsOneJobThatKnowsNoNames) {
  const std::vector<Job> jobs = plan(
      R"({"renders": [{"input": "a.mdk", "output": "f/####.png"},
                      {"input": "a.mdk", "output": "f/a.mp4"}]})");
  EXPECT_THAT(jobs[0].outputs, testing::IsEmpty());
  EXPECT_EQ(jobs[0].record, "records/f/all.png.json");
  EXPECT_THAT(jobs[1].outputs, ElementsAre("f/a.mp4"));
}

TEST_F(Plan, AVerifyReadsTheSourceAsItWasBaked) {
  const std::vector<Job> jobs = plan(R"({
    "bakes": [{"input": ["a.obj", "a.pc2"], "output": "a.mdk",
               "options": {"fps": 25, "clusters": 3}}],
    "verifies": [{"input": "*.mdk", "source": true}]})");
  EXPECT_THAT(jobs[1].command,
              ElementsAre("verify", "a.mdk", "--source=a.obj", "--source=a.pc2", "--fps=25"));
  EXPECT_EQ(jobs[1].record, "records/a.mdk.verify.json");
}

TEST_F(Plan, RecordsStayInTheirFolderWhateverThePath) {
  const std::vector<Job> jobs = plan(R"({"records": "r", "bakes": [
    {"input": "a.glb", "output": "../x/./a.mdk"}, {"input": "a.glb", "output": "/tmp/a.mdk"}]})");
  EXPECT_EQ(jobs[0].record, "r/up/x/a.mdk.json");
  EXPECT_EQ(jobs[1].record, "r/tmp/a.mdk.json");
}

TEST_F(Plan, MistakesAreToldWithTheirPlaceAndCure) {
  const auto refused = [&](const std::string& json, const std::vector<std::string>& words) {
    const std::string sentence = refusal(json);
    EXPECT_THAT(sentence, testing::StartsWith(folder_.manifest() + ": ")) << json;
    for (const std::string& word : words) EXPECT_THAT(sentence, HasSubstr(word)) << json;
    EXPECT_EQ(sentence.find('\n'), std::string::npos) << sentence;
  };
  refused("{\"bakes\": [\n{\"input\": \"a\",\n}]}", {"line 3"});
  refused("[]", {"the manifest: must be an object"});
  refused("{}", {"nothing to do"});
  refused(R"({"bake": []})", {"/bake: no field", "bakes"});
  refused(R"({"bakes": {}})", {"/bakes: must be a list"});
  refused(R"({"bakes": [7]})", {"/bakes/0: must be an object"});
  refused(R"({"bakes": [{"output": "a"}]})", {"/bakes/0: has no \"input\""});
  refused(R"({"bakes": [{"input": "a.glb"}]})", {"/bakes/0: has no \"output\""});
  refused(R"({"bakes": [{"input": "", "output": "a"}]})", {"/bakes/0/input"});
  refused(R"({"bakes": [{"input": "a\nb", "output": "a"}]})", {"/bakes/0/input", "rename"});
  refused(R"({"bakes": [{"input": "*.none", "output": "a"}]})", {"/bakes/0/input", "*.none"});
  refused(R"({"bakes": [{"input": "a", "output": "{what}"}]})", {"/bakes/0/output", "{stem}"});
  refused(R"({"bakes": [{"input": "a", "outptu": "b"}]})", {"/bakes/0/outptu", "output"});
  refused(R"({"bakes": [{"input": "a", "output": "b", "memory": "lots"}]})",
          {"/bakes/0/memory", "512M"});
  refused(R"({"bakes": [{"input": "a", "output": "b", "threads": 0}]})", {"/bakes/0/threads"});
  refused(R"({"bakes": [{"input": "a", "output": "b", "options": {"threads": 2}}]})",
          {"/bakes/0/options/threads", "beside \"options\""});
  refused(R"({"bakes": [{"input": "a", "output": "b", "options": {"fsp": 2}}]})",
          {"/bakes/0/options", "--fsp", "mdprep bake --help"});
  refused(R"({"bakes": [{"input": "a", "output": "b", "options": {"fps": {}}}]})",
          {"/bakes/0/options/fps"});
  refused(R"({"defaults": {"bake": {"output": "b"}}, "bakes": [{"input": "a", "output": "b"}]})",
          {"/defaults/bake/output"});
  refused(R"({"bakes": [{"input": "a", "output": "x"}, {"input": "b", "output": "./x"}]})",
          {"/bakes/1", "x is made by /bakes/0"});
  refused(R"({"bakes": [{"input": ["a.obj", "a.pc2"], "output": "./a.pc2"}]})",
          {"/bakes/0/output", "a.pc2 is the input"});
  refused(R"({"renders": [{"input": "a.mdk", "output": "#.png", "frames": "9:1"}]})",
          {"/renders/0/frames"});
  refused(R"({"renders": [{"input": ["a.mdk", "b.mdk"], "output": "#.png"}]})",
          {"/renders/0/input"});
  refused(R"({"verifies": [{"input": "a.mdk", "source": true}]})", {"/verifies/0/source"});
}

TEST_F(Plan, AManifestThatIsNotThereIsStatus4) { EXPECT_EQ(folder_.batch({"--list"}).status, 4); }

}  // namespace
}  // namespace mdk::test
