#include "preprocess/cli/view_options.h"

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

TEST(ViewOptions, ASizeIsTwoSidesInPixels) {
  const ImageSize size = parse_image_size("640x480");
  EXPECT_EQ(size.width, 640u);
  EXPECT_EQ(size.height, 480u);
  EXPECT_EQ(status_of_size("1x16384"), 0);
}

TEST(ViewOptions, RefusesSizesThatAreNone) {
  for (const char* wrong :
       {"", "x", "512", "512x", "x512", "0x0", "512x0", "-1x4", "4x4x4", "4 x 4", "4X4", "wide"})
    EXPECT_EQ(status_of_size(wrong), 2) << wrong;
}

TEST(ViewOptions, RefusesSizesPastTheLimitAsSuch) {
  EXPECT_EQ(status_of_size("16385x1"), 5);
  EXPECT_EQ(status_of_size("1x99999999999999999999999"), 5);
}

TEST(ViewOptions, ACameraIsTenNumbers) {
  const Camera camera = parse_camera("1 2 3  4,5,6 0 1 0 45.5");
  EXPECT_EQ(camera.eye, (Vec3f{1, 2, 3}));
  EXPECT_EQ(camera.target, (Vec3f{4, 5, 6}));
  EXPECT_EQ(camera.up, (Vec3f{0, 1, 0}));
  EXPECT_EQ(camera.vertical_fov_deg, 45.5f);
}

TEST(ViewOptions, RefusesCamerasThatSeeNothing) {
  for (const char* wrong :
       {"", "1 2 3", "1 2 3 4 5 6 0 1 0 45 1", "1 2 3 4 5 6 0 1 0 x", "1 2 3 1 2 3 0 1 0 45",
        "1 2 3 4 5 6 0 1 0 0", "1 2 3 4 5 6 0 1 0 180", "1 2 3 4 5 6 0 1 0 nan"})
    EXPECT_THROW(parse_camera(wrong), Error) << wrong;
}

TEST(ViewOptions, AllTechniquesLeaveTheOracleOut) {
  const std::vector<std::string> ids = parse_techniques("all");
  EXPECT_EQ(ids.size() + 1, technique_table().size());
  for (const std::string& id : ids) EXPECT_NE(id, "brute-force");
  EXPECT_EQ(parse_techniques("refit-bvh,brute-force"),
            (std::vector<std::string>{"refit-bvh", "brute-force"}));
}

TEST(ViewOptions, SomeTechniquesCanBeTakenOutAgain) {
  const std::vector<std::string> ids = parse_techniques("all,-static-kdtree,-auto,brute-force");
  EXPECT_EQ(ids.size() + 2, technique_table().size());
  EXPECT_EQ(std::count(ids.begin(), ids.end(), "static-kdtree"), 0);
  EXPECT_EQ(std::count(ids.begin(), ids.end(), "auto"), 0);
  EXPECT_EQ(ids.back(), "brute-force");
}

TEST(ViewOptions, RefusesTechniquesThatAreNotThere) {
  for (const char* wrong : {"", "bvh", "refit-bvh,", "refit-bvh,refit-bvh", "all,refit-bvh",
                            "all,-bvh", "refit-bvh,-refit-bvh", "refit-bvh,all"})
    EXPECT_THROW(parse_techniques(wrong), Error) << wrong;
}

}  // namespace
}  // namespace mdk
