// Two command lines have one option text exactly where they must have the same results.
#include "preprocess/cli/option_text.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "preprocess/cli/command_line.h"

namespace mdk {
namespace {

std::string text_of(std::vector<std::string> options, OptionScope scope = OptionScope::kContent) {
  options.insert(options.begin(), {"bake", "a.glb", "-o", "a.mdk"});
  CommandLine line;
  line.parse(options);
  return line.option_text(scope);
}

TEST(OptionText, HasWhatDiffersFromTheDefaultsSortedByName) {
  EXPECT_EQ(text_of({}), "");
  EXPECT_EQ(text_of({"--stop", "5", "--clips", "run", "--fps", "24"}),
            "clips=run\nfps=24\nstop=5\n");
  EXPECT_EQ(text_of({"--fps", "24.0"}), text_of({"--fps", "24"}));
  EXPECT_EQ(text_of({"--fps", "30", "--refine", "on", "--clusters", "auto"}), "");
  EXPECT_NE(text_of({"--clips", "10"}), text_of({"--clips", "10.0"})) << "names, not numbers";
}

TEST(OptionText, LeavesOutWhatNoResultDependsOn) {
  const std::vector<std::string> machine = {
      "--threads", "3", "--isa", "sse4", "--progress", "never", "--memory-limit", "1G", "-q"};
  EXPECT_EQ(text_of(machine), "");
  EXPECT_EQ(text_of(machine, OptionScope::kResults), "INPUT=a.glb\noutput=a.mdk\n");
}

}  // namespace
}  // namespace mdk
