// Options become typed values or one sentence; and two command lines have one text of options
// exactly where they must have the same results.
#include "preprocess/tool/command.h"

#include <gmock/gmock.h>

#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#include "common/base/error.h"
#include "preprocess/commands/command_line.h"
#include "preprocess/tool/text.h"

namespace mdk {
namespace {

std::string text_of(std::vector<std::string> options, OptionScope scope = OptionScope::kContent) {
  options.insert(options.begin(), {"bake", "a.glb", "-o", "a.mdk"});
  Command line = mdprep_command();
  line.parse(options, std::cout);
  return line.chosen().options_text(scope);
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

/// A command with one option of each kind.
struct Sample {
  Command command{"sample", "Shows options."};
  int number = 0;
  bool is_loud = false;
  std::string name;
  std::vector<std::string> files;
  std::ostringstream out;

  Sample() {
    command.add_value("-n,--number", "none|N", "A number.", "7", number, [](std::string_view text) {
      return text == "none" ? 0 : static_cast<int>(parse_count(text, {1, 9}));
    });
    command.add_flag("--loud", "Whether to shout.", is_loud);
    command.add_text("--name", "NAME", "A name.", name).needs = "--loud";
    command.add_texts(OptionKind::kSome, "FILE", "", "Files.", files);
    command.set_version("sample 1.0");
    command.add_check([this] {
      if (number == 9 && is_loud) throw Error(ErrorCode::kUsage, "9 is too loud");
    });
  }
  bool parse(const std::vector<std::string>& words) { return command.parse(words, out); }
  std::string refusal(const std::vector<std::string>& words) {
    try {
      parse(words);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kUsage);
      return error.what();
    }
    return "";
  }
};

TEST(Command, ValuesAreTypedAndStandardOnesStandWhereNothingIsGiven) {
  Sample usual;
  EXPECT_TRUE(usual.parse({}));
  EXPECT_EQ(usual.number, 7);
  EXPECT_FALSE(usual.is_loud);
  Sample given;
  EXPECT_TRUE(given.parse({"a", "-n", "3", "b", "--loud", "--name=x"}));
  EXPECT_EQ(given.number, 3);
  EXPECT_TRUE(given.is_loud);
  EXPECT_EQ(given.name, "x");
  EXPECT_EQ(given.files, (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(given.command.option("--number").text(), "3");
}

TEST(Command, AWrongValueIsToldWithTheOptionAndTheText) {
  EXPECT_EQ(Sample().refusal({"--number", "0"}), "--number 0: expected a whole number from 1 to 9");
  EXPECT_EQ(Sample().refusal({"-n", "9", "--loud"}), "9 is too loud");
  EXPECT_THAT(Sample().refusal({"--name", "x"}), testing::HasSubstr("--name requires --loud"));
  EXPECT_THAT(Sample().refusal({"--nmae"}), testing::HasSubstr("--nmae; see 'sample --help'"));
}

TEST(Command, HelpAndVersionGoWhereTheyAreToldBeforeAnyValueIsLookedAt) {
  Sample help, version;
  EXPECT_FALSE(help.parse({"--number", "0", "--help"}));
  EXPECT_THAT(help.out.str(), testing::HasSubstr("-n,--number none|N"));
  EXPECT_FALSE(version.parse({"--version"}));
  EXPECT_EQ(version.out.str(), "sample 1.0\n");
}

}  // namespace
}  // namespace mdk
