#include "preprocess/cli/key_range.h"

#include <gtest/gtest.h>

#include "common/base/error.h"

namespace mdk {
namespace {

using Keys = std::vector<std::uint32_t>;

TEST(KeyRange, BothEndsBelongToIt) {
  EXPECT_EQ(parse_key_range("2:5", 10), (Keys{2, 3, 4, 5}));
  EXPECT_EQ(parse_key_range("7", 10), (Keys{7}));
  EXPECT_EQ(parse_key_range("0:0", 1), (Keys{0}));
}

TEST(KeyRange, AStepMayJumpPastTheEnd) {
  EXPECT_EQ(parse_key_range("0:9:4", 10), (Keys{0, 4, 8}));
  EXPECT_EQ(parse_key_range("3:9:100", 10), (Keys{3}));
  EXPECT_EQ(parse_key_range("3:9:4294967295", 10), (Keys{3})) << "the sum must not wrap round";
}

TEST(KeyRange, RefusesWhatIsNoRangeOfTheFile) {
  for (const char* wrong : {"", ":", "1:", ":1", "1:2:", "1:2:0", "1:2:3:4", "5:2", "0:10", "10",
                            "-1:2", "a:b", "1-2", "1:2:x"}) {
    try {
      parse_key_range(wrong, 10);
      ADD_FAILURE() << wrong << " was taken";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kUsage) << wrong;
      EXPECT_EQ(std::string(error.what()).rfind("--frames", 0), 0u) << error.what();
    }
  }
}

TEST(KeyRange, SpreadKeysReachFromFirstToLast) {
  EXPECT_EQ(spread_keys(3, 11), (Keys{0, 5, 10}));
  EXPECT_EQ(spread_keys(4, 10), (Keys{0, 3, 6, 9}));
  EXPECT_EQ(spread_keys(1, 10), (Keys{0}));
  EXPECT_EQ(spread_keys(20, 3), (Keys{0, 1, 2})) << "no more than there are";
  EXPECT_EQ(spread_keys(5, 1), (Keys{0}));
}

TEST(KeyRange, SpreadKeysRiseForEveryCount) {
  for (std::uint32_t wanted = 1; wanted < 60; ++wanted) {
    const Keys keys = spread_keys(wanted, 57);
    ASSERT_EQ(keys.size(), std::min(wanted, 57u));
    for (std::size_t i = 1; i < keys.size(); ++i) ASSERT_LT(keys[i - 1], keys[i]) << wanted;
  }
}

TEST(NumberedPath, FillsTheLastRunOfTheFileName) {
  EXPECT_EQ(numbered_path("out_####.png", 7), "out_0007.png");
  EXPECT_EQ(numbered_path("#.png", 123), "123.png");
  EXPECT_EQ(numbered_path("a#b/c_##.png", 5), "a#b/c_05.png");
  EXPECT_EQ(numbered_path("a##_b#.png", 5), "a##_b5.png");
  EXPECT_EQ(numbered_path("a##/plain.png", 5), "a##/plain.png");
}

TEST(NumberedPath, OnlyTheFileNameCanHoldANumber) {
  EXPECT_TRUE(has_number_place("a/b_#.png"));
  EXPECT_FALSE(has_number_place("a#/b.png"));
  EXPECT_FALSE(has_number_place("b.png"));
}

}  // namespace
}  // namespace mdk
