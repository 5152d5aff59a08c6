#include "viewer/options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>
#include <vector>

#include "common/base/error.h"
#include "common/trace/technique.h"

namespace mdk {
namespace {

using testing::HasSubstr;

std::optional<ViewerOptions> parse(std::vector<const char*> words, std::string* said = nullptr) {
  words.insert(words.begin(), "mdview");
  std::ostringstream out;
  const auto options = parse_options(static_cast<int>(words.size()), words.data(), out);
  if (said) *said = out.str();
  return options;
}

void expect_refused(const std::vector<const char*>& words, const char* part_of_sentence) {
  try {
    parse(words);
    ADD_FAILURE() << words[0] << " was accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kUsage);
    EXPECT_THAT(error.what(), HasSubstr(part_of_sentence));
    EXPECT_THAT(error.what(), testing::Not(HasSubstr("\n")));
  }
}

TEST(ViewerOptions, StartsEmptyWithoutWords) {
  const auto options = parse({});
  ASSERT_TRUE(options);
  EXPECT_EQ(options->file, "");
  EXPECT_FALSE(options->size);
  EXPECT_FALSE(options->camera);
  EXPECT_EQ(options->quit_after, 0u);
  EXPECT_EQ(options->start, StartMode::kPaused);
}

TEST(ViewerOptions, ReadsEveryOption) {
  const std::string technique(technique_table().back().id);
  const auto options = parse({"hand.mdk",
                              "--size",
                              "640x480",
                              "--technique",
                              technique.c_str(),
                              "--shading",
                              "normals",
                              "--time",
                              "1.25",
                              "--clip",
                              "grasp",
                              "--camera",
                              "1 2 3, 4 5 6, 0 1 0 30.5",
                              "--threads",
                              "3",
                              "--isa",
                              "sse4",
                              "--screenshot",
                              "a.png",
                              "--quit-after",
                              "12",
                              "--print-state",
                              "--compare",
                              "wipe",
                              "--against",
                              "refit-bvh",
                              "--tab",
                              "clusters",
                              "--play"});
  ASSERT_TRUE(options);
  EXPECT_EQ(options->file, "hand.mdk");
  EXPECT_EQ(options->size, (WindowSize{640, 480}));
  EXPECT_EQ(options->technique, technique);
  EXPECT_EQ(options->shading, ShadingMode::kNormals);
  EXPECT_EQ(options->time, 1.25);
  EXPECT_EQ(options->clip, "grasp");
  EXPECT_EQ(options->camera, (Camera{{1, 2, 3}, {4, 5, 6}, {0, 1, 0}, 30.5f}));
  EXPECT_EQ(options->threads, 3);
  EXPECT_EQ(options->isa, "sse4");
  EXPECT_EQ(options->screenshot, "a.png");
  EXPECT_EQ(options->quit_after, 12u);
  EXPECT_TRUE(options->print_state);
  EXPECT_EQ(options->start, StartMode::kPlaying);
  EXPECT_EQ(options->compare, CompareMode::kWipe);
  EXPECT_EQ(options->against, "refit-bvh");
  EXPECT_EQ(options->tab, PanelTab::kClusters);
}

TEST(ViewerOptions, RefusesWhatItDoesNotKnow) {
  expect_refused({"--frobnicate"}, "--frobnicate");
  expect_refused({"a.mdk", "b.mdk"}, "b.mdk");
  expect_refused({"--technique", "magic"}, "magic");
  expect_refused({"--shading", "plaid"}, "plaid");
  expect_refused({"--compare", "both"}, "both");
  expect_refused({"--against", "magic"}, "magic");
  expect_refused({"--tab", "secret"}, "secret");
}

TEST(ViewerOptions, RefusesSizesThatCannotBe) {
  for (const char* size : {"640", "640x", "x480", "0x480", "640x-480", "640x480x2", "1e3x480",
                           "640 x 480", "63x480", "99999999999999999999x480", "16385x480"})
    expect_refused({"--size", size}, "--size");
}

TEST(ViewerOptions, RefusesCamerasThatAreNotTenNumbersOrSeeNothing) {
  for (const char* camera : {"1 2 3", "1 2 3 4 5 6 0 1 0", "1 2 3 4 5 6 0 1 0 30 9",
                             "1 2 3 4 5 6 0 one 0 30", "1 2 3 4 5 6 0 1 0 30x"})
    expect_refused({"--camera", camera}, "ten numbers");
  EXPECT_THROW(parse({"--camera", "1 2 3 1 2 3 0 1 0 30"}), Error);
  EXPECT_THROW(parse({"--camera", "1 2 3 4 5 6 0 1 0 180"}), Error);
}

TEST(ViewerOptions, RefusesNumbersThatAreNone) {
  expect_refused({"--time", "soon"}, "--time");
  expect_refused({"--time=-1"}, "--time");
  expect_refused({"--time", "nan"}, "--time");
  expect_refused({"--threads=-2"}, "--threads");
  expect_refused({"--quit-after", "never"}, "--quit-after");
}

TEST(ViewerOptions, HelpAndVersionAnswerOnStdoutAndStartNothing) {
  std::string said;
  EXPECT_FALSE(parse({"--help"}, &said));
  for (const char* option :
       {"--size", "--technique", "--shading", "--time", "--clip", "--camera", "--threads", "--isa",
        "--screenshot", "--quit-after", "--print-state", "--compare", "--against", "--tab"})
    EXPECT_THAT(said, HasSubstr(option));
  EXPECT_FALSE(parse({"--version"}, &said));
  EXPECT_THAT(said, HasSubstr("mdview"));
}

}  // namespace
}  // namespace mdk
