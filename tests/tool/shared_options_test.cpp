#include "preprocess/tool/shared_options.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "common/base/error.h"
#include "common/trace/technique.h"

namespace mdk {
namespace {

int status_of_size(const std::string& text) {
  try {
    parse_image_size(text);
  } catch (const Error& error) {
    return error.exit_status();
  }
  return 0;
}

TEST(SharedOptions, ASizeIsTwoSidesInPixels) {
  const ImageSize size = parse_image_size("640x480");
  EXPECT_EQ(size.width, 640u);
  EXPECT_EQ(size.height, 480u);
  EXPECT_EQ(status_of_size("1x16384"), 0);
}

TEST(SharedOptions, RefusesSizesThatAreNone) {
  for (const char* wrong :
       {"", "x", "512", "512x", "x512", "0x0", "512x0", "-1x4", "4x4x4", "4 x 4", "4X4", "wide"})
    EXPECT_EQ(status_of_size(wrong), 2) << wrong;
}

TEST(SharedOptions, RefusesSizesPastTheLimitAsSuch) {
  EXPECT_EQ(status_of_size("16385x1"), 5);
  EXPECT_EQ(status_of_size("1x99999999999999999999999"), 5);
}

TEST(SharedOptions, ACameraIsTenNumbers) {
  const Camera camera = parse_camera("1 2 3  4,5,6 0 1 0 45.5");
  EXPECT_EQ(camera.eye, (Vec3f{1, 2, 3}));
  EXPECT_EQ(camera.target, (Vec3f{4, 5, 6}));
  EXPECT_EQ(camera.up, (Vec3f{0, 1, 0}));
  EXPECT_EQ(camera.vertical_fov_deg, 45.5f);
}

TEST(SharedOptions, RefusesCamerasThatSeeNothing) {
  for (const char* wrong :
       {"", "1 2 3", "1 2 3 4 5 6 0 1 0 45 1", "1 2 3 4 5 6 0 1 0 x", "1 2 3 1 2 3 0 1 0 45",
        "1 2 3 4 5 6 0 1 0 0", "1 2 3 4 5 6 0 1 0 180", "1 2 3 4 5 6 0 1 0 nan"})
    EXPECT_THROW(parse_camera(wrong), Error) << wrong;
}

TEST(SharedOptions, AllTechniquesLeaveTheOracleOut) {
  const std::vector<std::string> ids = parse_techniques("all");
  EXPECT_EQ(ids.size() + 1, technique_table().size());
  for (const std::string& id : ids) EXPECT_NE(id, "brute-force");
  EXPECT_EQ(parse_techniques("refit-bvh,brute-force"),
            (std::vector<std::string>{"refit-bvh", "brute-force"}));
}

TEST(SharedOptions, SomeTechniquesCanBeTakenOutAgain) {
  const std::vector<std::string> ids = parse_techniques("all,-static-kdtree,-auto,brute-force");
  EXPECT_EQ(ids.size() + 2, technique_table().size());
  EXPECT_EQ(std::count(ids.begin(), ids.end(), "static-kdtree"), 0);
  EXPECT_EQ(std::count(ids.begin(), ids.end(), "auto"), 0);
  EXPECT_EQ(ids.back(), "brute-force");
}

TEST(SharedOptions, RefusesTechniquesThatAreNotThere) {
  for (const char* wrong : {"", "bvh", "refit-bvh,", "refit-bvh,refit-bvh", "all,refit-bvh",
                            "all,-bvh", "refit-bvh,-refit-bvh", "refit-bvh,all"})
    EXPECT_THROW(parse_techniques(wrong), Error) << wrong;
}

using Keys = std::vector<std::uint32_t>;

TEST(KeyRange, BothEndsBelongToIt) {
  EXPECT_EQ(parse_key_range("2:5").keys(10), (Keys{2, 3, 4, 5}));
  EXPECT_EQ(parse_key_range("7").keys(10), (Keys{7}));
  EXPECT_EQ(parse_key_range("0:0").keys(1), (Keys{0}));
}

TEST(KeyRange, AStepMayJumpPastTheEnd) {
  EXPECT_EQ(parse_key_range("0:9:4").keys(10), (Keys{0, 4, 8}));
  EXPECT_EQ(parse_key_range("3:9:100").keys(10), (Keys{3}));
  EXPECT_EQ(parse_key_range("3:9:4294967295").keys(10), (Keys{3})) << "the sum must not wrap round";
}

TEST(KeyRange, RefusesWhatIsNoRangeOfTheFile) {
  for (const char* wrong : {"", ":", "1:", ":1", "1:2:", "1:2:0", "1:2:3:4", "5:2", "0:10", "10",
                            "-1:2", "a:b", "1-2", "1:2:x"}) {
    try {
      parse_key_range(wrong).keys(10);
      ADD_FAILURE() << wrong << " was taken";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kUsage) << wrong;
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

}  // namespace
}  // namespace mdk
