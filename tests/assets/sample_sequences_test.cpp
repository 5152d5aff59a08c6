// The samples that are made at build time: their sizes, their shape, and that they are the same
// everywhere.
#include <gtest/gtest.h>

#include "assets/ben_rig.h"
#include "assets/chicken_asset.h"
#include "assets/cloth_asset.h"
#include "assets/cow_asset.h"
#include "assets/dolphin_asset.h"
#include "tests/assets/mesh_topology.h"

namespace mdk {
namespace {

/// FNV-1a, 64 bits.
std::uint64_t hash_of(const std::vector<std::uint8_t>& bytes) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const std::uint8_t byte : bytes) hash = (hash ^ byte) * 0x100000001b3u;
  return hash;
}

Vec3d highest(const std::vector<Vec3d>& pose) {
  Vec3d top = pose[0];
  for (const Vec3d& p : pose)
    if (p.y > top.y) top = p;
  return top;
}

double lowest(const std::vector<Vec3d>& pose) {
  double low = pose[0].y;
  for (const Vec3d& p : pose) low = std::min(low, p.y);
  return low;
}

TEST(SampleSequences, TheCowIsOneSolidThatFallsAndIsSquashed) {
  const SampleSequence cow = make_cow();
  EXPECT_NEAR(static_cast<double>(cow.triangles.size()), 5804, 120);
  EXPECT_EQ(cow.poses.size(), 204u);
  EXPECT_EQ(unmatched_edges(cow.triangles), 0u);
  EXPECT_EQ(euler_characteristic(cow.triangles, cow.colors.size()), 2);
  const double rest = enclosed_volume(cow.triangles, cow.poses.front());
  double squashed = rest;
  for (const auto& pose : cow.poses)
    squashed = std::min(squashed, enclosed_volume(cow.triangles, pose));
  EXPECT_LT(squashed, 0.9 * rest);
  EXPECT_GT(squashed, 0.2 * rest);
  EXPECT_GT(lowest(cow.poses.front()), 1.0);
  EXPECT_LT(lowest(cow.poses[60]), 0.1);
  EXPECT_EQ(hash_of(encode_pc2(cow)), 0x8d99efee7a36142eu);
}

TEST(SampleSequences, TheChickenHasLooseEyesAndOneExtremeMoment) {
  const SampleSequence chicken = make_chicken();
  EXPECT_NEAR(static_cast<double>(chicken.triangles.size()), 5664, 120);
  EXPECT_EQ(chicken.poses.size(), 400u);
  EXPECT_EQ(unmatched_edges(chicken.triangles), 0u);
  EXPECT_EQ(euler_characteristic(chicken.triangles, chicken.colors.size()), 6) << "three solids";
  const double calm = highest(chicken.poses[0]).y, extreme = highest(chicken.poses[250]).y;
  EXPECT_GT(extreme, 2.2 * calm);
  EXPECT_LT(highest(chicken.poses[200]).y, 1.1 * calm);
  EXPECT_LT(highest(chicken.poses[399]).y, 1.1 * calm);
  EXPECT_EQ(hash_of(encode_pc2(chicken)), 0x2595a5f4943c9d1bu);
}

TEST(SampleSequences, TheDolphinSwimsForwardByItself) {
  const SampleSequence dolphin = make_dolphin();
  EXPECT_NEAR(static_cast<double>(dolphin.triangles.size()), 12377, 250);
  EXPECT_EQ(dolphin.poses.size(), 101u);
  EXPECT_EQ(unmatched_edges(dolphin.triangles), 0u);
  EXPECT_EQ(euler_characteristic(dolphin.triangles, dolphin.colors.size()), 2);
  const auto middle = [&](std::size_t key) {
    Vec3d sum;
    for (const Vec3d& p : dolphin.poses[key]) sum += p;
    return sum * (1.0 / static_cast<double>(dolphin.colors.size()));
  };
  EXPECT_GT(middle(100).x - middle(0).x, 0.15);
  EXPECT_EQ(hash_of(encode_pc2(dolphin)), 0x2f854d5c4aaa0217u);
}

TEST(SampleSequences, TheClothIsASheetThatNeitherTearsNorStretchesMuch) {
  const SampleSequence cloth = make_cloth();
  EXPECT_EQ(cloth.triangles.size(), 8978u);
  EXPECT_EQ(cloth.poses.size(), 100u);
  double longest = 0;
  for (const auto& pose : cloth.poses)
    for (const auto& t : cloth.triangles)
      longest = std::max(longest, length(pose[t[0]] - pose[t[1]]));
  EXPECT_LT(longest, 4 * 2.0 / 67) << "next to a corner that is jerked";
  EXPECT_EQ(hash_of(encode_pc2(cloth)), 0x0be05384eba55388u);
}

TEST(SampleSequences, FilesHoldWhatTheFormatsSay) {
  SampleSequence sequence;
  sequence.triangles = {{0, 1, 2}};
  sequence.colors = {{255, 0, 0}, {0, 0, 0}, {0, 0, 51}};
  sequence.poses = {{{0, 0, 0}, {1.5, 0, 0}, {0, -0.25, 1}}, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
  const std::vector<std::uint8_t> obj = encode_obj(sequence), pc2 = encode_pc2(sequence);
  EXPECT_EQ(std::string(obj.begin(), obj.end()),
            "v 0.000000 0.000000 0.000000 1.0000 0.0000 0.0000\n"
            "v 1.500000 0.000000 0.000000 0.0000 0.0000 0.0000\n"
            "v 0.000000 -0.250000 1.000000 0.0000 0.0000 0.2000\n"
            "f 1 2 3\n");
  ASSERT_EQ(pc2.size(), 32u + 2 * 3 * 12);
  EXPECT_EQ(pc2[16], 3) << "points";
  EXPECT_EQ(pc2[28], 2) << "frames";
}

TEST(Ben, RunsThirtyKeysThatJoinUp) {
  const BenRig rig = make_ben_rig();
  const RigClip run = make_ben_run(rig);
  ASSERT_EQ(run.poses.size(), 30u);
  EXPECT_EQ(rig.joints.size(), 19u);
  // The step from the last key to the first is like any other.
  double largest = 0, seam = 0;
  for (std::size_t key = 0; key < 30; ++key) {
    double step = 0;
    for (std::size_t j = 0; j < rig.joints.size(); ++j)
      step = std::max(step, length(run.poses[(key + 1) % 30][j] - run.poses[key][j]));
    (key == 29 ? seam : largest) = std::max(key == 29 ? seam : largest, step);
  }
  EXPECT_LE(seam, largest);
  EXPECT_GT(largest, 3);
  // Left does what right did half a stride before.
  const auto bend = [&](std::size_t key, int joint) {
    return run.poses[key][static_cast<std::size_t>(joint)].x;
  };
  for (std::size_t key = 0; key < 15; ++key)
    EXPECT_NEAR(bend(key, rig.sides[0].shin), bend(key + 15, rig.sides[1].shin), 1e-9);
}

}  // namespace
}  // namespace mdk
