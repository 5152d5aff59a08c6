// The committed ball: what the program makes, and a motion that respects the floor.
#include "assets/ball_asset.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "assets/ball_motion.h"
#include "common/base/parallel.h"
#include "common/math/aabb.h"
#include "formats/gltf/reader.h"
#include "tests/assets/glb_content.h"
#include "tests/assets/mesh_topology.h"

namespace mdk {
namespace {

const char* const kPath = MDK_SOURCE_DIR "/assets/ball.glb";

TEST(BallAsset, CommittedFileIsWhatTheProgramMakes) {
  EXPECT_EQ(difference(parse_glb(read_bytes(kPath)), parse_glb(encode_glb(make_ball_scene()))), "")
      << "run \"make_sample ball assets\" and commit the new assets/ball.glb";
}

TEST(BallAsset, IsSmall) { EXPECT_LT(read_bytes(kPath).size(), 300'000u); }

class BallMotion : public ::testing::Test {
 protected:
  void SetUp() override {
    SilentProgress progress;
    sequence_ = read_gltf(kPath, {}, progress).sequence;
    for (const Triangle& t : sequence_.triangles)
      if (moves(t.v[0])) ball_.push_back({t.v[0], t.v[1], t.v[2]});
    ASSERT_FALSE(ball_.empty());
    ASSERT_LT(ball_.size(), sequence_.triangles.size()) << "the floor must not move";
  }

  bool moves(std::uint32_t vertex) const {
    const Vec3f start = sequence_.pose(0)[vertex];
    for (std::uint32_t key = 1; key < sequence_.key_count(); ++key)
      if (length(sequence_.pose(key)[vertex] - start) > 1e-6f) return true;
    return false;
  }

  Aabb ball_box(std::uint32_t key) const {
    Aabb box;
    for (const auto& t : ball_)
      for (const std::uint32_t v : t) box.extend(sequence_.pose(key)[v]);
    return box;
  }

  double ball_volume(std::uint32_t key) const {
    std::vector<Vec3d> positions;
    for (const Vec3f& p : sequence_.pose(key)) positions.push_back(to_double(p));
    return enclosed_volume(ball_, positions);
  }

  PoseSequence sequence_;
  std::vector<TriangleIndices> ball_;
};

TEST_F(BallMotion, NeverSinksIntoTheFloorAndStandsOnItWhenSquashed) {
  for (std::uint32_t key = 0; key < sequence_.key_count(); ++key) {
    const Aabb box = ball_box(key);
    EXPECT_GT(box.lo.y, -0.0005f) << "key " << key;
    const bool squashed = box.extent().y < 1.9 * kBallRadius * 0.01;
    EXPECT_TRUE(!squashed || box.lo.y < 0.002f) << "key " << key << " at " << box.lo.y;
  }
}

TEST_F(BallMotion, SquashesAndKeepsItsVolume) {
  const double radius = kBallRadius * 0.01;
  const double whole = 4.0 / 3 * std::numbers::pi * radius * radius * radius;
  float flattest = 1;
  for (std::uint32_t key = 0; key < sequence_.key_count(); ++key) {
    EXPECT_NEAR(ball_volume(key) / whole, 1, 0.05) << "key " << key;
    flattest = std::min(flattest, ball_box(key).extent().y);
  }
  EXPECT_LT(flattest, 1.5 * radius);
}

TEST_F(BallMotion, BouncesInALoop) {
  ASSERT_EQ(sequence_.clips.size(), 2u);
  const Clip& clip = sequence_.clips[1];
  EXPECT_EQ(clip.name, "bounce");
  const auto first = sequence_.pose(clip.first_key);
  const auto last = sequence_.pose(clip.first_key + clip.key_count - 1);
  for (std::size_t v = 0; v < first.size(); ++v) EXPECT_LT(length(last[v] - first[v]), 1e-5f);
}

}  // namespace
}  // namespace mdk
