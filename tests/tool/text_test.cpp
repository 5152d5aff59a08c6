#include "preprocess/tool/text.h"

#include <gtest/gtest.h>

#include <sstream>

#include "common/base/error.h"

namespace mdk {
namespace {

TEST(NumberText, CountsAreWholeNumbersInRange) {
  EXPECT_EQ(parse_count("1", {}), 1u);
  EXPECT_EQ(parse_count("4294967295", {}), 4294967295u);
  EXPECT_EQ(parse_count("0", {0, 9}), 0u);
  for (const char* wrong : {"", "0", "-1", "+1", " 1", "1 ", "1.0", "1e3", "0x1", "4294967296",
                            "99999999999999999999", "one"})
    EXPECT_THROW(parse_count(wrong, {}), Error) << wrong;
}

TEST(NumberText, AFailedCountNamesTheRange) {
  try {
    parse_count("0", {1, 64});
    FAIL() << "0 was taken";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kUsage);
    EXPECT_STREQ(error.what(), "expected a whole number from 1 to 64");
  }
}

TEST(NumberText, SizesTakeBinaryUnits) {
  EXPECT_EQ(parse_size("1"), 1u);
  EXPECT_EQ(parse_size("1500000"), 1500000u);
  EXPECT_EQ(parse_size("512M"), std::uint64_t{512} << 20);
  EXPECT_EQ(parse_size("1.5G"), std::uint64_t{3} << 29);
  for (const char* wrong : {"", "0", "-1", "M", "1m", "1 G", "1GB", "inf", "nan", "1e30T", "none"})
    EXPECT_THROW(parse_size(wrong), Error) << wrong;
}

TEST(NumberText, RealsAreWholeWordsAndFinite) {
  EXPECT_EQ(parse_real("0.5"), 0.5);
  EXPECT_EQ(parse_real("-2e-3"), -2e-3);
  for (const char* wrong : {"", "nan", "inf", "-inf", "1e999", "1,5", "1 ", "five"})
    EXPECT_THROW(parse_real(wrong), Error) << wrong;
}

TEST(NumberText, SplitKeepsEmptyParts) {
  EXPECT_EQ(split("a,b", ','), (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(split("", ','), (std::vector<std::string>{""}));
  EXPECT_EQ(split(",a,", ','), (std::vector<std::string>{"", "a", ""}));
}

TEST(NumberText, SizesAreWrittenAsTheyAreRead) {
  for (const std::uint64_t bytes : {std::uint64_t{1}, std::uint64_t{3} << 29, std::uint64_t{12345}})
    EXPECT_EQ(parse_size(size_text(bytes)), bytes);
  EXPECT_EQ(size_text(std::uint64_t{2} << 30), "2048M");
}

TEST(NumberText, OneOfFewWordsOrASentenceThatListsThem) {
  const auto parse = one_of<int>({{"one", 1}, {"two", 2}, {"three", 3}});
  EXPECT_EQ(parse("two"), 2);
  try {
    parse("Two");
    FAIL() << "another word was taken";
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "expected one, two or three");
  }
}

TEST(TextTable, AlignsNamesLeftAndNumbersRight) {
  TextTable table(1);
  table.add_row({"name", "n"});
  table.add_row({"a", "10"});
  table.add_row({"long name"});
  std::ostringstream out;
  table.print(out);
  EXPECT_EQ(out.str(), "name        n\na          10\nlong name\n");
}

}  // namespace
}  // namespace mdk
