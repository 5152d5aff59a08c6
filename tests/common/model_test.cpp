// Times and keys in the clip table.
#include "common/motion/model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <random>

namespace mdk {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

/// Clips of 3, 1 and 4 keys; the second starts late.
ModelStorage three_clips() {
  ModelStorage storage;
  storage.clips = {{"a", 0, 3}, {"b", 3, 1}, {"c", 4, 4}};
  storage.key_times = {0, 0.5, 2, 1.5, 0.25, 1, 1.0 + 1e-12, 9};
  return storage;
}

TEST(LocateTime, GivesAKeyAloneAtItsExactTime) {
  const ModelStorage storage = three_clips();
  const ModelView model = storage.view();
  for (std::uint32_t c = 0; c < model.clips.size(); ++c) {
    const Clip& clip = model.clips[c];
    for (std::uint32_t k = clip.first_key; k < clip.first_key + clip.key_count; ++k) {
      EXPECT_EQ(locate_time(model, c, model.key_times[k]), at_key(k)) << "key " << k;
    }
  }
}

TEST(LocateTime, LiesLinearlyBetweenNeighbours) {
  const ModelStorage storage = three_clips();
  const ModelView model = storage.view();
  EXPECT_EQ(locate_time(model, 0, 0.125), (KeyInterval{0, 1, 0.25f}));
  EXPECT_EQ(locate_time(model, 0, 1.25), (KeyInterval{1, 2, 0.5f}));
  EXPECT_EQ(locate_time(model, 2, 0.625), (KeyInterval{4, 5, 0.5f}));
  EXPECT_EQ(locate_time(model, 2, 1.0 + 1e-12 + (8 - 1e-12) * 0.75), (KeyInterval{6, 7, 0.75f}));
}

TEST(LocateTime, OfAModelThatHoldsAtKeysOnlyIsTheNearestKey) {
  ModelStorage storage = three_clips();
  storage.holds_between_keys = false;
  const ModelView model = storage.view();
  EXPECT_EQ(locate_time(model, 0, 0.2), at_key(0));
  EXPECT_EQ(locate_time(model, 0, 0.25), at_key(0)) << "half-way it is the earlier";
  EXPECT_EQ(locate_time(model, 0, 0.26), at_key(1));
  EXPECT_EQ(locate_time(model, 0, 1.5), at_key(2));
  EXPECT_EQ(locate_time(model, 2, 0.625), at_key(4));
  EXPECT_EQ(locate_time(model, 2, 8), at_key(7));
}

TEST(LocateTime, ClampsToTheClipAndTakesNanAsItsStart) {
  const ModelStorage storage = three_clips();
  const ModelView model = storage.view();
  EXPECT_EQ(locate_time(model, 0, -1), at_key(0));
  EXPECT_EQ(locate_time(model, 0, 3), at_key(2));
  EXPECT_EQ(locate_time(model, 1, 0), at_key(3));
  EXPECT_EQ(locate_time(model, 1, 99), at_key(3));
  EXPECT_EQ(locate_time(model, 2, 0), at_key(4)) << "before a clip whose first key is late";
  EXPECT_EQ(locate_time(model, 2, -kInf), at_key(4));
  EXPECT_EQ(locate_time(model, 2, kInf), at_key(7));
  EXPECT_EQ(locate_time(model, 2, std::nan("")), at_key(4));
}

TEST(LocateTime, NeverGivesOneOrZeroBetweenKeys) {
  const ModelStorage storage = three_clips();
  const ModelView model = storage.view();
  // One step before a key: as a float, s would be 1.
  EXPECT_EQ(locate_time(model, 0, std::nextafter(0.5, 0.0)), at_key(1));
  EXPECT_EQ(locate_time(model, 0, std::nextafter(2.0, 0.0)), at_key(2));
  // So little after a key that s is no float.
  EXPECT_EQ(locate_time(model, 0, std::numeric_limits<double>::denorm_min()), at_key(0));
  constexpr unsigned kSeed = 20240607;
  std::printf("seed %u\n", kSeed);
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> anywhere(-1, 10);
  for (int i = 0; i < 20000; ++i) {
    for (std::uint32_t c = 0; c < model.clips.size(); ++c) {
      const double seconds = anywhere(random);
      const KeyInterval at = locate_time(model, c, seconds);
      ASSERT_EQ(clip_of_key(model, at.key0), c);
      ASSERT_EQ(clip_of_key(model, at.key1), c);
      if (at.key0 == at.key1) {
        ASSERT_EQ(at.s, 0.0f);
        continue;
      }
      ASSERT_EQ(at.key1, at.key0 + 1);
      ASSERT_GT(at.s, 0.0f);
      ASSERT_LT(at.s, 1.0f);
      ASSERT_LE(model.key_times[at.key0], seconds);
      ASSERT_LT(seconds, model.key_times[at.key1]);
    }
  }
}

TEST(LocateTime, SurvivesTimesThatSpanTheDoubles) {
  ModelStorage storage;
  storage.clips = {{"wide", 0, 3}};
  storage.key_times = {0, std::numeric_limits<double>::denorm_min(),
                       std::numeric_limits<double>::max()};
  const ModelView model = storage.view();
  const KeyInterval at = locate_time(model, 0, std::numeric_limits<double>::max() / 2);
  EXPECT_EQ(at, (KeyInterval{1, 2, 0.5f}));
}

TEST(ClipOfKey, FindsTheClipThatHoldsTheKey) {
  const ModelStorage storage = three_clips();
  const ModelView model = storage.view();
  const std::uint32_t expected[] = {0, 0, 0, 1, 2, 2, 2, 2};
  for (std::uint32_t key = 0; key < 8; ++key) EXPECT_EQ(clip_of_key(model, key), expected[key]);
}

TEST(ClipBounds, HoldTheMeshAtEveryKeyOfTheClipAndNoOther) {
  ModelStorage storage = three_clips();
  for (std::size_t i = 0; i < 8; ++i) {
    const auto at = static_cast<float>(2 * i);
    storage.key_boxes.push_back({{at, 0, 0}, {at + 2, 1, 1}});
  }
  const ModelView model = storage.view();
  EXPECT_EQ(clip_bounds(model, 0), (Aabb{{0, 0, 0}, {6, 1, 1}}));
  EXPECT_EQ(clip_bounds(model, 1), (Aabb{{6, 0, 0}, {8, 1, 1}}));
  EXPECT_EQ(clip_bounds(model, 2), (Aabb{{8, 0, 0}, {16, 1, 1}}));
}

}  // namespace
}  // namespace mdk
