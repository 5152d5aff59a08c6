#include "preprocess/cli/number_text.h"

#include <gtest/gtest.h>

#include "common/base/error.h"

namespace mdk {
namespace {

TEST(NumberText, CountsAreWholeNumbersInRange) {
  EXPECT_EQ(parse_count("--n", "1", {}), 1u);
  EXPECT_EQ(parse_count("--n", "4294967295", {}), 4294967295u);
  EXPECT_EQ(parse_count("--n", "0", {0, 9}), 0u);
  for (const char* wrong : {"", "0", "-1", "+1", " 1", "1 ", "1.0", "1e3", "0x1", "4294967296",
                            "99999999999999999999", "one"})
    EXPECT_THROW(parse_count("--n", wrong, {}), Error) << wrong;
}

TEST(NumberText, AFailedCountNamesOptionValueAndRange) {
  try {
    parse_count("--threads", "0", {1, 64});
    FAIL() << "0 was taken";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kUsage);
    EXPECT_STREQ(error.what(), "--threads 0: expected a whole number from 1 to 64");
  }
}

TEST(NumberText, SizesTakeBinaryUnits) {
  EXPECT_EQ(parse_size("--m", "1"), 1u);
  EXPECT_EQ(parse_size("--m", "1500000"), 1500000u);
  EXPECT_EQ(parse_size("--m", "512M"), std::uint64_t{512} << 20);
  EXPECT_EQ(parse_size("--m", "1.5G"), std::uint64_t{3} << 29);
  for (const char* wrong : {"", "0", "-1", "M", "1m", "1 G", "1GB", "inf", "nan", "1e30T", "none"})
    EXPECT_THROW(parse_size("--m", wrong), Error) << wrong;
}

TEST(NumberText, RealsAreWholeWordsAndFinite) {
  EXPECT_EQ(parse_real("--x", "0.5"), 0.5);
  EXPECT_EQ(parse_real("--x", "-2e-3"), -2e-3);
  for (const char* wrong : {"", "nan", "inf", "-inf", "1e999", "1,5", "1 ", "five"})
    EXPECT_THROW(parse_real("--x", wrong), Error) << wrong;
}

TEST(NumberText, SplitKeepsEmptyParts) {
  EXPECT_EQ(split("a,b", ','), (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(split("", ','), (std::vector<std::string>{""}));
  EXPECT_EQ(split(",a,", ','), (std::vector<std::string>{"", "a", ""}));
}

}  // namespace
}  // namespace mdk
