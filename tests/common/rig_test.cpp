#include "common/motion/rig.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/common/random_rig.h"

namespace mdk {
namespace {

constexpr std::uint32_t kKeys = 3;

/// One vertex at a key, in double, straight from the definition.
Vec3d defined_position(const Rig& rig, std::uint32_t key, std::uint32_t vertex) {
  const std::size_t bones = rig.bone_maps.size() / kKeys;
  const std::size_t targets = rig.target_weights.size() / kKeys;
  Vec3d p = to_double(rig.base_positions[vertex]);
  if (!rig.first_offset.empty())
    for (std::uint32_t i = rig.first_offset[vertex]; i < rig.first_offset[vertex + 1]; ++i)
      p += to_double(rig.morph_offsets[i].offset) *
           static_cast<double>(rig.target_weights[key * targets + rig.morph_offsets[i].target]);
  Vec3d sum;
  for (std::uint32_t i = rig.first_weight[vertex]; i < rig.first_weight[vertex + 1]; ++i)
    sum += to_double(rig.bone_maps[key * bones + rig.bone_weights[i].bone]).point(p) *
           static_cast<double>(rig.bone_weights[i].weight);
  return sum;
}

std::vector<Vec3f> posed(const Rig& rig, std::uint32_t key) {
  const auto vertices = static_cast<std::uint32_t>(rig.base_positions.size());
  std::vector<Vec3f> out(vertices);
  pose_vertices(rig.view(), rig_pose(rig.view(), key, kKeys), {0, vertices}, out);
  return out;
}

/// Largest distance between the poses of two rigs, vertex i of `a` being vertex kept[i] of `b`.
double largest_distance(const Rig& a, const Rig& b, std::span<const std::uint32_t> kept) {
  double largest = 0;
  for (std::uint32_t key = 0; key < kKeys; ++key) {
    const std::vector<Vec3f> of_a = posed(a, key), of_b = posed(b, key);
    for (std::size_t i = 0; i < kept.size(); ++i)
      largest = std::max(largest, length(to_double(of_a[i]) - to_double(of_b[kept[i]])));
  }
  return largest;
}

std::vector<std::uint32_t> all_vertices(const Rig& rig) {
  std::vector<std::uint32_t> all(rig.base_positions.size());
  for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
  return all;
}

TEST(Rig, PosesVerticesAsDefined) {
  const Rig rig = random_rig({.vertices = 200, .keys = kKeys}, 11);
  for (std::uint32_t key = 0; key < kKeys; ++key) {
    const std::vector<Vec3f> got = posed(rig, key);
    for (std::uint32_t v = 0; v < got.size(); ++v)
      EXPECT_LT(length(to_double(got[v]) - defined_position(rig, key, v)), 2e-4) << v;
  }
}

TEST(Rig, ARigidPartIsMovedByItsBoneAlone) {
  Rig rig = random_rig({.vertices = 1, .keys = kKeys, .targets = 0}, 12);
  rig.bone_weights = {{3, 1.0f}};
  rig.first_weight = {0, 1};
  for (std::uint32_t key = 0; key < kKeys; ++key)
    EXPECT_EQ(posed(rig, key)[0], rig.bone_maps[key * 5 + 3].point(rig.base_positions[0]));
}

TEST(Rig, SelectedVerticesKeepTheirPoses) {
  const Rig rig = random_rig({.vertices = 40, .keys = kKeys}, 13);
  const std::vector<std::uint32_t> kept = {39, 3, 17, 0};
  EXPECT_EQ(largest_distance(select_vertices(rig, kept), rig, kept), 0);
}

TEST(Rig, SimplifyingKeepsThePoses) {
  Rig rig = random_rig({.vertices = 100, .keys = kKeys, .bones = 9, .targets = 4}, 14);
  for (std::uint32_t key = 0; key < kKeys; ++key) {
    rig.bone_maps[key * 9 + 7] = rig.bone_maps[key * 9 + 2];
    rig.target_weights[key * 4 + 1] = 0;
  }
  Rig simple = rig;
  simplify_rig(simple, kKeys);
  EXPECT_LT(largest_distance(simple, rig, all_vertices(rig)), 2e-4);
  EXPECT_EQ(simple.bone_maps.size(), kKeys * 8u);
  EXPECT_EQ(simple.target_weights.size(), kKeys * 3u);
  for (std::size_t v = 0; v < 100; ++v)
    for (std::uint32_t i = simple.first_weight[v] + 1; i < simple.first_weight[v + 1]; ++i)
      EXPECT_LT(simple.bone_weights[i - 1].bone, simple.bone_weights[i].bone);
}

TEST(Rig, SimplifyingDropsBonesAndTargetsThatMoveNothing) {
  Rig rig = random_rig({.vertices = 2, .keys = kKeys, .bones = 6, .targets = 2}, 15);
  rig.bone_weights = {{4, 1.0f}, {1, 0.5f}, {4, 0.5f}};
  rig.first_weight = {0, 1, 3};
  rig.morph_offsets.clear();
  rig.first_offset = {0, 0, 0};
  simplify_rig(rig, kKeys);
  EXPECT_EQ(rig.bone_maps.size(), kKeys * 2u);
  EXPECT_THAT(rig.bone_weights,
              testing::ElementsAre(BoneWeight{1, 1.0f}, BoneWeight{0, 0.5f}, BoneWeight{1, 0.5f}));
  EXPECT_TRUE(rig.target_weights.empty());
  EXPECT_TRUE(rig.first_offset.empty());
}

TEST(Rig, WeightsOfBonesThatAreOneAddUpToOneAgain) {
  Rig rig = random_rig({.vertices = 1, .keys = kKeys, .bones = 3, .targets = 0}, 16);
  for (std::uint32_t key = 0; key < kKeys; ++key)
    rig.bone_maps[3 * key + 1] = rig.bone_maps[3 * key + 2] = rig.bone_maps[3 * key];
  rig.bone_weights = {{0, 0.1f}, {1, 0.3f}, {2, 0.6f}};
  rig.first_weight = {0, 3};
  simplify_rig(rig, kKeys);
  EXPECT_THAT(rig.bone_weights, testing::ElementsAre(BoneWeight{0, 1.0f}));
}

TEST(Rig, VerticesAreAlikeWhereAllTheirNumbersAre) {
  Rig rig;
  rig.base_positions = {{1, 0, 0}, {1, -0.0f, 0}, {1, 0, 0}, {1, 0, 0}, {2, 0, 0}, {1, 0, 0}};
  rig.bone_weights = {{0, 1}, {0, 1}, {1, 1}, {0, 1}, {0, 1}, {0, 1}};
  rig.first_weight = {0, 1, 2, 3, 4, 5, 6};
  rig.morph_offsets = {{0, {0, 0, 1}}};
  rig.first_offset = {0, 0, 0, 0, 1, 1, 1};
  EXPECT_THAT(lowest_alike_vertices(rig, {}), testing::ElementsAre(0, 0, 2, 3, 4, 0));
  const std::vector<std::uint64_t> groups = {7, 7, 7, 7, 7, 8};
  EXPECT_THAT(lowest_alike_vertices(rig, groups), testing::ElementsAre(0, 0, 2, 3, 4, 5));
}

}  // namespace
}  // namespace mdk
