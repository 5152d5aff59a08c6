// Quantised poses keep their bound, and the model is built for what they decode to.
#include "preprocess/pose/pose_quantizer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "common/base/error.h"
#include "common/base/parallel.h"
#include "common/motion/posed_mesh.h"
#include "preprocess/pipeline.h"
#include "tests/preprocess/moving_meshes.h"

namespace mdk {
namespace {

constexpr double kError = 1e-4;

/// Parts that each go their own way, bending a little.
PoseSequence bending_parts() {
  PoseSequence sequence = independent_parts(4, 12);
  for (std::uint32_t key = 0; key < sequence.key_count(); ++key)
    for (Vec3f& p : sequence.pose(key))
      p.z += 0.02f * std::sin(3.0f * p.x + static_cast<float>(key));
  return sequence;
}

DecomposeResult quantized(const PoseSequence& sequence, std::optional<double> error) {
  DecomposeOptions options;
  options.quantize = error;
  SilentProgress progress;
  return decompose(sequence, options, progress);
}

TEST(QuantizedPoses, NoVertexIsFartherOffThanAskedFor) {
  const PoseSequence source = bending_parts();
  const ModelStorage storage = quantized(source, kError).model;
  const ModelView model = storage.view();
  ASSERT_EQ(model.poses.kind, PoseKind::kQuantized);
  PosedMesh mesh(model);
  double largest = 0;
  for (std::uint32_t key = 0; key < model.key_count(); ++key) {
    mesh.set_time(at_key(key));
    for (std::uint32_t t = 0; t < model.triangle_count(); ++t)
      for (std::size_t corner = 0; corner < 3; ++corner) {
        const std::uint32_t v = source.triangles[model.source_triangles[t]].v[corner];
        largest =
            std::max(largest, length(to_double(mesh.positions()[model.triangles[t].v[corner]]) -
                                     to_double(source.pose(key)[v])));
      }
  }
  EXPECT_LE(largest, kError * model.rest_diagonal);
  EXPECT_GT(largest, 0);
  const QuantizationError& error = model.poses.quantized.error.front();
  EXPECT_EQ(error.bound, kError);
  EXPECT_NEAR(error.largest * model.rest_diagonal, largest, 1e-3 * largest);
}

TEST(QuantizedPoses, TakeLessRoomThanKeyPositions) {
  const ModelStorage storage = quantized(bending_parts(), kError).model;
  const QuantizedPoses& poses = storage.poses.quantized;
  const std::size_t bytes = poses.words.size() * 4 + poses.blocks.size() * sizeof(QuantizedBlock) +
                            poses.rest_positions.size() * sizeof(Vec3f);
  EXPECT_LT(bytes, storage.key_times.size() * storage.vertex_count * sizeof(Vec3f) / 2);
}

TEST(QuantizedPoses, BoxesHoldWhatIsDecoded) {
  const ModelStorage storage = quantized(bending_parts(), 1e-3).model;
  const ModelView model = storage.view();
  PosedMesh mesh(model);
  for (std::uint32_t key = 0; key < model.key_count(); ++key) {
    mesh.set_time(at_key(key));
    for (std::uint32_t c = 0; c < model.cluster_count(); ++c)
      for (std::uint32_t t = model.clusters[c].first_triangle;
           t < model.clusters[c].first_triangle + model.clusters[c].triangle_count; ++t)
        for (const std::uint32_t v : model.triangles[t].v)
          EXPECT_TRUE(model.world_box(key, c).contains(mesh.positions()[v]));
  }
}

TEST(QuantizedPoses, APartThatIsNearlyFlatAtOneKeyTakesNoFinerSteps) {
  PoseSequence sequence = bending_parts();
  for (Vec3f& p : sequence.pose(5)) p.z *= 1e-5f;
  EXPECT_EQ(quantized(sequence, 1e-5).model.poses.kind, PoseKind::kQuantized);
}

TEST(QuantizedPoses, AnErrorThatCannotBeKeptIsRefused) {
  try {
    quantized(bending_parts(), 1e-9);
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kUsage);
    EXPECT_THAT(error.what(), testing::HasSubstr("--quantize 1e-09"));
  }
}

TEST(QuantizedPoses, ARigThatTakesLessRoomStaysExact) {
  PoseSequence sequence = independent_parts(1, 60);
  Rig rig;
  rig.first_weight = {0};
  for (std::uint32_t v = 0; v < sequence.vertex_count; ++v) {
    rig.base_positions.push_back(sequence.pose(0)[v]);
    rig.bone_weights.push_back({0, 1});
    rig.first_weight.push_back(v + 1);
  }
  for (std::uint32_t key = 0; key < sequence.key_count(); ++key)
    rig.bone_maps.push_back(to_float(rigid_motion({0, 0, 1}, 0.1 * key, {0.1 * key, 0, 0})));
  sequence.rig = rig;
  decode_positions(sequence);
  EXPECT_EQ(quantized(sequence, kError).model.poses.kind, PoseKind::kRig);
}

TEST(QuantizedPoses, DoNotDependOnTheNumberOfThreads) {
  ScratchList<std::uint32_t> words[2];
  for (int threads = 1; threads <= 2; ++threads) {
    const ThreadLimit limit(threads);
    words[threads - 1] = quantized(bending_parts(), kError).model.poses.quantized.words;
  }
  EXPECT_EQ(words[0], words[1]);
}

}  // namespace
}  // namespace mdk
