// mdprep verify, started as a user does, on sound files and on files that lie.
#include <gmock/gmock.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "common/trace/technique.h"
#include "formats/mdk/writer.h"
#include "tests/commands/baked_sample.h"
#include "tests/commands/program_run.h"
#include "tests/commands/sample_model.h"

namespace mdk::test {
namespace {

using testing::HasSubstr;
using Json = nlohmann::json;

class Verify : public BakedSample {};

bool is_judged(const TechniqueInfo& technique) {
  return technique.kind != TechniqueKind::kOracle && technique.kind != TechniqueKind::kPeer;
}

TEST_F(Verify, ASoundFileIsOkAgainstItsSourceToo) {
  const Outcome run = run_mdprep({"verify", baked(), "--source", source(), "-q"});
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run.err, "");
  EXPECT_EQ(run.out.substr(run.out.size() - 4), "\nok\n");
  EXPECT_THAT(run.out, HasSubstr("200 random times, seed 1\n"));
  EXPECT_THAT(run.out, HasSubstr("largest error 0 of the diagonal"));
  for (const TechniqueInfo& technique : technique_table())
    if (is_judged(technique)) {
      EXPECT_THAT(run.out, HasSubstr(std::string(technique.id) + " gives brute force's hits"));
    }
}

TEST_F(Verify, JsonHasCountsForEveryCheck) {
  const Outcome run =
      run_mdprep({"verify", baked(), "--json", "-q", "--samples", "17", "--seed", "99"});
  ASSERT_EQ(run.status, 0) << run.err;
  const Json report = Json::parse(run.out);
  EXPECT_EQ(report["schema"], "mdprep-verify/1");
  EXPECT_EQ(report["seed"], 99);
  EXPECT_EQ(report["samples"], 17);
  EXPECT_EQ(report["hit_mismatches"], 0);
  EXPECT_EQ(report["ok"], true);
  EXPECT_EQ(std::ssize(report["checks"]),
            2 + 5 + 2 + std::ranges::count_if(technique_table(), is_judged));
  for (const Json& check : report["checks"]) {
    EXPECT_GT(check["count"], 0) << check;
    EXPECT_EQ(check["failures"], 0) << check;
  }
}

TEST_F(Verify, ADataByteThatFlippedIsStatus3) {
  std::string bytes = read_text(baked());
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 0x10);
  write_text(folder_.file("flipped.mdk"), bytes);
  const Outcome run = run_mdprep({"verify", folder_.file("flipped.mdk"), "-q"});
  EXPECT_EQ(run.status, 3);
  EXPECT_TRUE(is_one_sentence(run.err)) << run.err;
}

TEST_F(Verify, ABoxThatLiesIsFoundThoughEveryChecksumFits) {
  ModelStorage model = sample_model();
  model.fuzzy_boxes[7].hi = model.fuzzy_boxes[7].lo;
  write_mdk(model.view(), folder_.file("lies.mdk"));
  const Outcome run = run_mdprep({"verify", folder_.file("lies.mdk"), "-q"});
  EXPECT_EQ(run.status, 3);
  EXPECT_TRUE(is_one_sentence(run.err)) << run.err;
  EXPECT_THAT(run.out, HasSubstr("FAILED  fuzzy boxes hold their triangles at keys"));
  EXPECT_THAT(run.out, HasSubstr("first: triangle 7 at key "));
  EXPECT_THAT(run.out, HasSubstr("checks failed\n"));
}

TEST_F(Verify, AnotherRateThanTheBakesIsFoundInTheSource) {
  const Outcome run =
      run_mdprep({"verify", baked(), "--source", source(), "--fps", "24", "--json", "-q"});
  EXPECT_EQ(run.status, 3);
  const Json report = Json::parse(run.out);
  EXPECT_EQ(report["ok"], false);
  EXPECT_EQ(report["hit_mismatches"], 0);
}

}  // namespace
}  // namespace mdk::test
