#include "preprocess/stage_shares.h"

#include <gtest/gtest.h>

namespace mdk {
namespace {

TEST(StageShares, EndInOrderWhateverTheModeAndSize) {
  for (const DecomposeMode mode :
       {DecomposeMode::kMotion, DecomposeMode::kBones, DecomposeMode::kNone})
    for (const double positions : {3.0, 1e6})
      for (const std::uint32_t segments : {0u, 1u}) {
        DecomposeOptions options;
        options.mode = mode;
        options.segments = segments;
        const StageEnds ends = predict_stage_ends({positions, 1}, options);
        EXPECT_LE(0, ends.clustered);
        EXPECT_LT(ends.clustered, ends.mapped);
        EXPECT_LT(ends.mapped, ends.ordered);
        EXPECT_LE(ends.ordered, ends.segmented);
        EXPECT_LT(ends.segmented, ends.boxed);
        EXPECT_LT(ends.boxed, 1);
      }
}

TEST(StageShares, ManyKeysMakeTheirMapsTheLongestWork) {
  const StageEnds few = predict_stage_ends({4e5, 8e4}, {});
  EXPECT_GT(few.clustered, 0.5);
  const StageEnds many = predict_stage_ends({2e7, 8e4}, {});
  EXPECT_LT(many.clustered, 0.25);
  EXPECT_GT(many.mapped - many.clustered, 0.5);
}

TEST(StageShares, WhatIsLeftOutTakesNoTime) {
  DecomposeOptions options;
  options.segments = 1;
  const StageEnds uncut = predict_stage_ends({1e6, 100}, options);
  EXPECT_EQ(uncut.ordered, uncut.segmented);
  options.mode = DecomposeMode::kBones;
  EXPECT_EQ(predict_stage_ends({1e6, 100}, options).clustered, 0);
  const StageEnds of_bones = predict_stage_ends({1e6, 100}, options);
  options.mode = DecomposeMode::kNone;
  EXPECT_LT(predict_stage_ends({1e6, 100}, options).mapped, of_bones.mapped / 2);
}

}  // namespace
}  // namespace mdk
