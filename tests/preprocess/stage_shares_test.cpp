#include "preprocess/stage_shares.h"

#include <gtest/gtest.h>

namespace mdk {
namespace {

/// A sequence of a size, with nothing in it.
PoseSequence sized(std::size_t triangles, std::size_t positions) {
  PoseSequence sequence;
  sequence.triangles.resize(triangles);
  sequence.positions.resize(positions);
  return sequence;
}

TEST(StageShares, EndInOrderWhateverTheModeAndSize) {
  for (const DecomposeMode mode :
       {DecomposeMode::kMotion, DecomposeMode::kBones, DecomposeMode::kNone})
    for (const std::size_t positions : {std::size_t{3}, std::size_t{1'000'000}})
      for (const std::uint32_t segments : {0u, 1u}) {
        DecomposeOptions options;
        options.mode = mode;
        options.segments = segments;
        const StageEnds ends = predict_stage_ends(sized(1, positions), options);
        EXPECT_LE(0, ends.clustered);
        EXPECT_LT(ends.clustered, ends.mapped);
        EXPECT_LE(ends.mapped, ends.segmented);
        EXPECT_LT(ends.segmented, ends.boxed);
        EXPECT_LT(ends.boxed, 1);
      }
}

TEST(StageShares, ManyKeysMakeTheirMapsTheLongestWork) {
  const StageEnds few = predict_stage_ends(sized(80'000, 400'000), {});
  EXPECT_GT(few.clustered, 0.5);
  const StageEnds many = predict_stage_ends(sized(80'000, 20'000'000), {});
  EXPECT_LT(many.clustered, 0.25);
  EXPECT_GT(many.mapped - many.clustered, 0.5);
}

TEST(StageShares, WhatIsLeftOutTakesNoTime) {
  DecomposeOptions options;
  options.segments = 1;
  const StageEnds uncut = predict_stage_ends(sized(100, 1'000'000), options);
  EXPECT_EQ(uncut.mapped, uncut.segmented);
  options.mode = DecomposeMode::kBones;
  EXPECT_EQ(predict_stage_ends(sized(100, 1'000'000), options).clustered, 0);
}

}  // namespace
}  // namespace mdk
