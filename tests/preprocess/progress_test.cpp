// What a decomposition tells of how far it is, and the shares of time that stands on.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "preprocess/pipeline.h"
#include "tests/preprocess/moving_meshes.h"

namespace mdk {
namespace {

TEST(Decompose, ReportsProgressThatOnlyRises) {
  struct Recorder final : ProgressSink {
    double last = 0;
    std::vector<std::string> stages;
    void report(std::string_view name, double fraction) override {
      EXPECT_GE(fraction, 0);
      EXPECT_LE(fraction, 1);
      if (stages.empty() || stages.back() != name) stages.emplace_back(name);
      EXPECT_GE(fraction, last);
      longest_silence = std::max(longest_silence, fraction - last);
      last = fraction;
    }
    double longest_silence = 0;
  };
  for (const bool paper : {false, true}) {
    Recorder recorder;
    DecomposeOptions options;
    if (paper) options.stop_percent = 1;
    decompose(wild_motion(87, 10), options, recorder);
    EXPECT_EQ(recorder.stages, (std::vector<std::string>{"decompose", "build"}));
    EXPECT_EQ(recorder.last, 1);
    EXPECT_LT(recorder.longest_silence, 0.7);
  }
}

/// Stage "build", from one report to the next.
struct BuildSilence final : ProgressSink {
  void report(std::string_view name, double fraction) override {
    if (name == "build" && last > 0) longest = std::max(longest, fraction - last);
    last = name == "build" ? fraction : 0;
  }
  double last = 0, longest = 0;
};

TEST(Decompose, OneLongSegmentIsNotSilentWhileItsBoxesAreMade) {
  PoseSequence sequence;
  sequence.vertex_count = 3000;
  for (std::uint32_t i = 0; i + 2 < sequence.vertex_count; i += 3)
    sequence.triangles.push_back({{i, i + 1, i + 2}});
  sequence.appearance.materials.resize(1);
  sequence.appearance.triangle_materials.assign(sequence.triangles.size(), 0);
  constexpr std::uint32_t kKeys = 3000;  // nine million positions
  for (std::uint32_t key = 0; key < kKeys; ++key) {
    sequence.key_times.push_back(key);
    for (std::uint32_t i = 0; i < sequence.vertex_count; ++i)
      sequence.positions.push_back(
          {static_cast<float>(i % 3), static_cast<float>(i + key % 7), static_cast<float>(i % 2)});
  }
  sequence.clips = {{"clip", 0, kKeys}};
  DecomposeOptions options;
  options.mode = DecomposeMode::kNone;
  options.segments = 1;
  BuildSilence silence;
  decompose(std::move(sequence), options, silence);
  EXPECT_GT(silence.longest, 0);
  EXPECT_LT(silence.longest, 0.12);
}

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
