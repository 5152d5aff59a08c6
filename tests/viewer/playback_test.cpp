#include "viewer/state/playback.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace mdk {
namespace {

Playback two_clips() { return Playback({{"walk", {0, 0.1, 0.2, 0.4, 1.0}}, {"wave", {0, 2}}}); }

TEST(Playback, StandsAtTheStartOfTheFirstClipPaused) {
  const Playback playback = two_clips();
  EXPECT_EQ(playback.clip(), 0u);
  EXPECT_EQ(playback.time(), 0);
  EXPECT_EQ(playback.seconds(), 1);
  EXPECT_FALSE(playback.playing());
}

TEST(Playback, TimePassesOnlyWhilePlaying) {
  Playback playback = two_clips();
  EXPECT_FALSE(playback.advance(0.3));
  EXPECT_EQ(playback.time(), 0);
  playback.play();
  EXPECT_TRUE(playback.advance(0.3));
  EXPECT_DOUBLE_EQ(playback.time(), 0.3);
  playback.toggle();
  EXPECT_FALSE(playback.advance(0.3));
  EXPECT_DOUBLE_EQ(playback.time(), 0.3);
}

TEST(Playback, SpeedScalesTime) {
  Playback playback = two_clips();
  playback.set_speed(0.5);
  playback.play();
  playback.advance(0.6);
  EXPECT_DOUBLE_EQ(playback.time(), 0.3);
  playback.set_speed(1e9);
  EXPECT_EQ(playback.speed(), kMaxSpeed);
  playback.set_speed(-1);
  EXPECT_EQ(playback.speed(), kMinSpeed);
  playback.set_speed(std::nan(""));
  EXPECT_EQ(playback.speed(), kMinSpeed);
}

TEST(Playback, PlayingEndsAtAClipOfOneKey) {
  for (const LoopMode loop : {LoopMode::kOnce, LoopMode::kLoop, LoopMode::kPingPong}) {
    Playback playback({{"walk", {0, 1}}, {"still", {0}}});
    playback.set_loop(loop);
    playback.play();
    playback.set_clip(1);
    EXPECT_FALSE(playback.advance(0.1));
    EXPECT_EQ(playback.time(), 0);
    EXPECT_FALSE(playback.playing());
  }
}

TEST(Playback, PlayingEndsWhereTheClipHasOneKeyWhenTheFileIsLoadedAgain) {
  Playback playback({{"walk", {0, 1}}});
  playback.play();
  playback.set_clips({{"still", {0}}});
  EXPECT_FALSE(playback.advance(0.1));
  EXPECT_EQ(playback.time(), 0);
  EXPECT_FALSE(playback.playing());
}

TEST(Playback, LoopStartsOver) {
  Playback playback = two_clips();
  playback.play();
  playback.seek(0.9);
  playback.advance(2.3);
  EXPECT_NEAR(playback.time(), 0.2, 1e-12);
  EXPECT_TRUE(playback.playing());
}

TEST(Playback, OnceStopsAtTheEndAndPlaysAgainFromTheStart) {
  Playback playback = two_clips();
  playback.set_loop(LoopMode::kOnce);
  playback.play();
  playback.advance(7);
  EXPECT_EQ(playback.time(), 1);
  EXPECT_FALSE(playback.playing());
  playback.play();
  EXPECT_EQ(playback.time(), 0);
  EXPECT_TRUE(playback.playing());
}

TEST(Playback, PingPongGoesThereAndBack) {
  Playback playback = two_clips();
  playback.set_loop(LoopMode::kPingPong);
  playback.play();
  playback.advance(0.8);
  EXPECT_NEAR(playback.time(), 0.8, 1e-12);
  playback.advance(0.5);  // 1.3: on the way back
  EXPECT_NEAR(playback.time(), 0.7, 1e-12);
  playback.advance(0.2);
  EXPECT_NEAR(playback.time(), 0.5, 1e-12);
  playback.advance(0.8);  // past the start: forward again
  EXPECT_NEAR(playback.time(), 0.3, 1e-12);
  playback.advance(0.1);
  EXPECT_NEAR(playback.time(), 0.4, 1e-12);
}

TEST(Playback, StepsFromKeyToKeyAndPauses) {
  Playback playback = two_clips();
  playback.play();
  playback.seek(0.15);
  playback.step_key(StepDirection::kForward);
  EXPECT_EQ(playback.time(), 0.2);
  EXPECT_FALSE(playback.playing());
  playback.step_key(StepDirection::kForward);
  EXPECT_EQ(playback.time(), 0.4);
  playback.seek(0.15);
  playback.step_key(StepDirection::kBack);
  EXPECT_EQ(playback.time(), 0.1);
  playback.step_key(StepDirection::kBack);
  EXPECT_EQ(playback.time(), 0);
}

TEST(Playback, StepsWrapAroundWhereTheClipLoops) {
  Playback playback = two_clips();
  playback.step_key(StepDirection::kBack);
  EXPECT_EQ(playback.time(), 1);
  playback.step_key(StepDirection::kForward);
  EXPECT_EQ(playback.time(), 0);
  playback.set_loop(LoopMode::kOnce);
  playback.step_key(StepDirection::kBack);
  EXPECT_EQ(playback.time(), 0);
  playback.go_to_end();
  playback.step_key(StepDirection::kForward);
  EXPECT_EQ(playback.time(), 1);
}

TEST(Playback, KeyIsTheLastOneAtOrBeforeTheTime) {
  Playback playback = two_clips();
  EXPECT_EQ(playback.key(), 0u);
  playback.seek(0.2);
  EXPECT_EQ(playback.key(), 2u);
  playback.seek(0.39);
  EXPECT_EQ(playback.key(), 2u);
  playback.go_to_end();
  EXPECT_EQ(playback.key(), 4u);
}

TEST(Playback, SeekStaysInTheClip) {
  Playback playback = two_clips();
  playback.seek(-3);
  EXPECT_EQ(playback.time(), 0);
  playback.seek(std::numeric_limits<double>::infinity());
  EXPECT_EQ(playback.time(), 1);
  playback.seek(std::nan(""));
  EXPECT_EQ(playback.time(), 1);
}

TEST(Playback, AnotherClipStartsAtItsStartAndPlaysOn) {
  Playback playback = two_clips();
  playback.play();
  playback.seek(0.7);
  EXPECT_TRUE(playback.set_clip("wave"));
  EXPECT_EQ(playback.clip(), 1u);
  EXPECT_EQ(playback.time(), 0);
  EXPECT_EQ(playback.seconds(), 2);
  EXPECT_TRUE(playback.playing());
  EXPECT_FALSE(playback.set_clip("dance"));
  playback.set_clip(99);
  EXPECT_EQ(playback.clip(), 1u);
}

TEST(Playback, HoldsTheTimeWhileScrubbedAndPlaysOnAfterwards) {
  Playback playback = two_clips();
  playback.play();
  playback.begin_scrub();
  playback.seek(0.5);
  EXPECT_FALSE(playback.advance(0.2));
  EXPECT_EQ(playback.time(), 0.5);
  playback.end_scrub();
  EXPECT_TRUE(playback.advance(0.2));
  EXPECT_DOUBLE_EQ(playback.time(), 0.7);
}

TEST(Playback, OneKeyOrNoClipHasNothingToPlay) {
  const std::vector<ClipTimes> one_key = {{"still", {0}}};
  Playback still(one_key), none;
  for (Playback* playback : {&still, &none}) {
    playback->play();
    EXPECT_FALSE(playback->playing());
    EXPECT_FALSE(playback->advance(1));
    playback->step_key(StepDirection::kForward);
    playback->step_key(StepDirection::kBack);
    playback->go_to_end();
    EXPECT_EQ(playback->time(), 0);
    EXPECT_EQ(playback->key(), 0u);
  }
}

TEST(Playback, TimeNeverLeavesTheClip) {
  constexpr unsigned kSeed = 7;
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  std::exponential_distribution<double> elapsed(2);
  Playback playback = two_clips();
  for (int i = 0; i < 20000; ++i) {
    switch (random() % 8) {
      case 0:
        playback.toggle();
        break;
      case 1:
        playback.set_loop(static_cast<LoopMode>(random() % 3));
        break;
      case 2:
        playback.set_speed(elapsed(random) * 4);
        break;
      case 3:
        playback.set_clip(random() % 3);
        break;
      case 4:
        playback.step_key(random() % 2 ? StepDirection::kBack : StepDirection::kForward);
        break;
      default:
        playback.advance(elapsed(random));
        break;
    }
    ASSERT_GE(playback.time(), 0);
    ASSERT_LE(playback.time(), playback.seconds());
    ASSERT_LT(playback.key(), playback.clips()[playback.clip()].key_times.size());
  }
}

TEST(PlaybackRange, PlayingStaysInside) {
  for (const LoopMode loop : {LoopMode::kOnce, LoopMode::kLoop, LoopMode::kPingPong}) {
    Playback playback = two_clips();
    playback.set_range(0.8, 0.2);  // in either order
    ASSERT_EQ(playback.range(), (TimeRange{0.2, 0.8}));
    playback.set_loop(loop);
    playback.play();
    EXPECT_EQ(playback.time(), 0.2) << "it begins at the range's start";
    std::mt19937 random(7);
    std::uniform_real_distribution<double> step(0, 0.9);
    for (int i = 0; i < 500; ++i) {
      playback.advance(step(random));
      EXPECT_GE(playback.time(), 0.2);
      EXPECT_LE(playback.time(), 0.8);
    }
    EXPECT_EQ(playback.playing(), loop != LoopMode::kOnce);
  }
}

TEST(PlaybackRange, LoopsAndPingPongsByItsOwnLength) {
  Playback playback = two_clips();
  playback.set_range(0.2, 0.8);
  playback.play();
  playback.advance(0.7);  // 0.9 is 0.1 past the end
  EXPECT_DOUBLE_EQ(playback.time(), 0.3);
  playback.seek(0.2);
  playback.set_loop(LoopMode::kPingPong);
  playback.advance(0.7);
  EXPECT_DOUBLE_EQ(playback.time(), 0.7);
}

TEST(PlaybackRange, IsClampedAndClearedAndRefusesWhatIsNoNumber) {
  Playback playback = two_clips();
  playback.set_range(-3, 7);
  EXPECT_EQ(playback.range(), (TimeRange{0, 1}));
  playback.set_range(0.1, std::nan(""));
  EXPECT_EQ(playback.range(), (TimeRange{0, 1}));
  playback.set_range(0.5, 0.5);
  EXPECT_FALSE(playback.range());
  playback.set_range(0.1, 0.4);
  playback.go_to_end();
  EXPECT_EQ(playback.time(), 0.4);
  playback.set_clip(std::size_t{1});
  EXPECT_FALSE(playback.range());
  Playback none;
  none.set_range(0, 1);
  none.begin_range_here();
  none.end_range_here();
  EXPECT_FALSE(none.range());
  EXPECT_EQ(none.nearest_key_time(3), 0);
}

TEST(PlaybackRange, EndsAreSetHereAndAnEndThatPassesTheOtherBeginsAnew) {
  Playback playback = two_clips();
  playback.seek(0.3);
  playback.begin_range_here();
  EXPECT_EQ(playback.range(), (TimeRange{0.3, 1}));
  playback.seek(0.6);
  playback.end_range_here();
  EXPECT_EQ(playback.range(), (TimeRange{0.3, 0.6}));
  playback.seek(0.8);
  playback.begin_range_here();
  EXPECT_EQ(playback.range(), (TimeRange{0.8, 1}));
  playback.seek(0.1);
  playback.end_range_here();
  EXPECT_EQ(playback.range(), (TimeRange{0, 0.1}));
}

TEST(PlaybackRange, SurvivesAFileThatChangedAsFarAsTheClipReaches) {
  Playback playback = two_clips();
  playback.set_range(0.4, 1);
  playback.set_clips({{"other", {0, 9}}, {"walk", {0, 0.7}}});
  EXPECT_EQ(playback.range(), (TimeRange{0.4, 0.7}));
  playback.set_clips({{"other", {0, 9}}});
  EXPECT_FALSE(playback.range());
}

TEST(Playback, KnowsTheNearestKey) {
  const Playback playback = two_clips();
  EXPECT_EQ(playback.nearest_key_time(0.29), 0.2);
  EXPECT_EQ(playback.nearest_key_time(0.31), 0.4);
  EXPECT_EQ(playback.nearest_key_time(-5), 0);
  EXPECT_EQ(playback.nearest_key_time(5), 1);
}

}  // namespace
}  // namespace mdk
