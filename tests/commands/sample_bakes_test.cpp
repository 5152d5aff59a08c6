// The samples that come with the project, and a sequence of positions alone, baked as by default:
// boxes hold at thousands of random times, and no thread count or instruction set shows.
#include <gtest/gtest.h>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/isa.h"
#include "common/base/parallel.h"
#include "preprocess/commands/checks.h"
#include "preprocess/commands/source.h"
#include "preprocess/pipeline.h"
#include "preprocess/tool/text.h"
#include "tests/preprocess/moving_meshes.h"

namespace mdk::test {
namespace {

constexpr std::uint32_t kMoments = 2000;
constexpr std::uint64_t kSeed = 1301;

struct Sample {
  const char* name;
  const char* clips;  ///< of the file of that name; none: a sheet that bends, twists and shakes
};

PoseSequence read_sample(const Sample& sample) {
  if (sample.clips == nullptr) return wild_motion(kSeed, 120);
  ReadOptions options;
  options.clips = split(sample.clips, ',');
  SilentProgress progress;
  const std::string path = std::string(MDK_SOURCE_DIR) + "/assets/" + sample.name + ".glb";
  return read_source(find_source(std::vector<std::string>{path}), options, progress).sequence;
}

DecomposeResult bake(PoseSequence sequence) {
  SilentProgress progress;
  return decompose(std::move(sequence), {}, progress);
}

class SampleBake : public testing::TestWithParam<Sample> {};

TEST_P(SampleBake, HoldsItsTrianglesAtThousandsOfRandomTimes) {
  const DecomposeResult result = bake(read_sample(GetParam()));
  const ModelView model = result.model.view();
  SilentProgress progress;
  std::printf("seed %llu\n", static_cast<unsigned long long>(kSeed));
  for (const CheckResult& check :
       check_boxes(model, random_moments(model, kMoments, kSeed), progress)) {
    EXPECT_GE(check.count, kMoments) << check.name;
    EXPECT_EQ(check.failures, 0u) << check.name << ": " << check.detail;
  }
}

TEST_P(SampleBake, IsTheSameForAnyThreadCountAndInstructionSet) {
  const PoseSequence sequence = read_sample(GetParam());
  std::vector<unsigned char> expected;
  {
    const ThreadLimit limit(1);
    expected = model_bytes(bake(sequence).model);
  }
  {
    const ThreadLimit limit(2);
    EXPECT_TRUE(model_bytes(bake(sequence).model) == expected) << "two threads";
  }
  for (const std::string_view isa : available_isas()) {
    limit_isa(isa);
    EXPECT_TRUE(model_bytes(bake(sequence).model) == expected) << isa;
  }
  reset_isa();
}

INSTANTIATE_TEST_SUITE_P(Cli, SampleBake,
                         testing::Values(Sample{"hand", "beckon"}, Sample{"ball", "throw"},
                                         Sample{"sheet", nullptr}),
                         [](const auto& tested) { return std::string(tested.param.name); });

}  // namespace
}  // namespace mdk::test
