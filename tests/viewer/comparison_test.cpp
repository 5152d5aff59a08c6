// Two techniques held together: the pictures made of two, and what the worker makes for them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <thread>

#include "common/trace/technique.h"
#include "formats/mdk/writer.h"
#include "tests/viewer/waving_bar.h"
#include "viewer/picture/requests.h"
#include "viewer/picture/shown_picture.h"

namespace mdk {
namespace {

using testing::ElementsAre;

constexpr std::uint32_t kA = 0xff202020, kB = 0xff302010;

class Pair : public testing::Test {
 protected:
  std::vector<std::uint32_t> first_ = {kA, kA, kA, kA, kA, kA, kA, kA};
  std::vector<std::uint32_t> second_ = {kB, kB, kB, kB, kB, kB, kB, kB};
  PicturePair pair_{first_, second_, 4, 2};
};

TEST_F(Pair, AWipeShowsTheFirstLeftOfTheDivider) {
  EXPECT_THAT(wipe(pair_, 0.25f).pixels, ElementsAre(kA, kB, kB, kB, kA, kB, kB, kB));
  EXPECT_EQ(wipe(pair_, 0).pixels, second_);
  EXPECT_EQ(wipe(pair_, 1).pixels, first_);
}

TEST_F(Pair, SideBySideIsTwiceAsWide) {
  const Picture picture = side_by_side(pair_);
  EXPECT_EQ(picture.width, 8u);
  EXPECT_EQ(picture.height, 2u);
  EXPECT_THAT(picture.pixels,
              ElementsAre(kA, kA, kA, kA, kB, kB, kB, kB, kA, kA, kA, kA, kB, kB, kB, kB));
}

TEST_F(Pair, TheDifferenceCountsPixelsAndTheLargestStep) {
  second_ = first_;
  EXPECT_EQ(difference_of(pair_).pixels, 0u);
  second_[5] = kB;
  const PictureDifference difference = difference_of(pair_);
  EXPECT_EQ(difference.pixels, 1u);
  EXPECT_EQ(difference.largest, 0x10u);
}

TEST_F(Pair, ADifferenceIsMarkedRedAndAgreementIsGrey) {
  const auto is_grey = [](std::uint32_t p) {
    return (p & 255) == (p >> 8 & 255) && (p & 255) == (p >> 16 & 255);
  };
  second_ = first_;
  for (const std::uint32_t pixel : difference_picture(pair_).pixels) EXPECT_TRUE(is_grey(pixel));
  second_[0] ^= 1;
  const Picture marked = difference_picture(pair_);
  EXPECT_GT(marked.pixels[0] & 255, 100u);
  EXPECT_FALSE(is_grey(marked.pixels[0]));
  EXPECT_TRUE(is_grey(marked.pixels[3]));  // out of the mark's reach
}

class ComparedFrames : public testing::Test {
 protected:
  ComparedFrames() {
    const std::string path = testing::TempDir() + "mdview_compared.mdk";
    write_mdk(test::waving_bar().view(), path);
    job_.file = std::make_shared<const MdkFile>(path);
    std::filesystem::remove(path);  // the mapping stays
    job_.request.width = 96;
    job_.request.height = 64;
    job_.request.camera = fit_camera(job_.file->model().bounds, 1.5);
    job_.request.at = locate_time(job_.file->model(), 0, 0.37);
  }

  FinishedFrame frame() {
    RenderWorker worker([] {});
    worker.request(job_);
    while (worker.busy()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    return *worker.take_finished();
  }

  RenderJob job_;
};

TEST_F(ComparedFrames, TechniquesOfOursDoNotDifferInAnyPixel) {
  for (std::size_t row = 0; row < technique_table().size(); ++row) {
    if (technique_table()[row].kind == TechniqueKind::kPeer) continue;
    job_.against = row;
    const FinishedFrame both = frame();
    ASSERT_TRUE(both.second) << both.error;
    EXPECT_GT(both.second->stats.hits, 100u);
    EXPECT_GT(both.second->stats.time_to_image_ms(), 0);
    EXPECT_EQ(both.difference.pixels, 0u) << technique_table()[row].id;
  }
}

TEST_F(ComparedFrames, AnotherSecondTechniqueIsAnotherPicture) {
  RenderJob other = job_;
  other.against = 1;
  EXPECT_FALSE(same_picture(job_, other));
}

TEST_F(ComparedFrames, TheStateKeepsTheTimesOfBoth) {
  job_.against = 2;
  const FinishedFrame both = frame();
  ViewState state;
  EXPECT_TRUE(note_costs(both, state));
  ASSERT_TRUE(state.frames.second);
  EXPECT_EQ(state.frames.second->technique, 2u);
  EXPECT_EQ(state.frames.second->stats.hits, both.second->stats.hits);
  EXPECT_EQ(state.frames.difference->pixels, 0u);
  job_.against.reset();
  EXPECT_TRUE(note_costs(frame(), state));
  EXPECT_FALSE(state.frames.second);
}

TEST_F(ComparedFrames, AShownPictureFollowsTheDividerWithoutATrace) {
  job_.against = 2;
  FinishedFrame both = frame();
  both.second->pixels.assign(both.pixels.size(), kB);
  ShownPicture shown;
  CompareSettings settings{.mode = CompareMode::kWipe, .against = 2, .divider = 1};
  shown.show(both, settings);
  EXPECT_EQ(shown.picture().pixels, both.pixels);
  EXPECT_FALSE(shown.arrange(settings));
  settings.divider = 0;
  EXPECT_TRUE(shown.arrange(settings));
  EXPECT_EQ(shown.picture().pixels, both.second->pixels);
  settings.mode = CompareMode::kSideBySide;  // needs frames of half the width
  EXPECT_FALSE(shown.arrange(settings));
}

}  // namespace
}  // namespace mdk
