#include "preprocess/pose/pose_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/preprocess/moving_meshes.h"

namespace mdk {
namespace {

using testing::Contains;
using testing::ElementsAre;

PoseSequence with_stretched_keys(std::uint32_t keys, std::vector<std::uint32_t> stretched) {
  const Mesh mesh = curved_sheet(3);
  return make_sequence(mesh, keys, [&, stretched](std::uint32_t k, std::uint32_t i) {
    const bool far = std::find(stretched.begin(), stretched.end(), k) != stretched.end();
    const Vec3d v = mesh.vertices[i];
    return Vec3d{v.x * (far ? 2.0 + k : 1.0) + 10.0 * k, v.y + 0.001 * k * v.x, v.z};
  });
}

TEST(KeySampling, TakesAllKeysWhereTheyAreFew) {
  EXPECT_THAT(sample_keys(with_stretched_keys(3, {}), 5), ElementsAre(0, 1, 2));
}

TEST(KeySampling, FindsTheFewExtremePosesAmongManyAlike) {
  const auto keys = sample_keys(with_stretched_keys(200, {37, 118, 171}), 4);
  EXPECT_EQ(keys.size(), 4u);
  for (const std::uint32_t k : {37u, 118u, 171u}) EXPECT_THAT(keys, Contains(k));
}

TEST(KeySampling, WalkingAwayMakesNoPoseDifferent) {
  const Mesh mesh = curved_sheet(3);
  const PoseSequence walk = make_sequence(mesh, 50, [&](std::uint32_t k, std::uint32_t i) {
    return mesh.vertices[i] + Vec3d{k == 20 ? 1000.0 : 0.0, 0, 0} +
           Vec3d{0, k == 33 ? mesh.vertices[i].x : 0.0, 0};
  });
  EXPECT_THAT(sample_keys(walk, 1), ElementsAre(33));
}

TEST(KeySampling, NamesNoPoseTwice) {
  const Mesh mesh = curved_sheet(3);
  const PoseSequence still =
      make_sequence(mesh, 30, [&](std::uint32_t, std::uint32_t i) { return mesh.vertices[i]; });
  EXPECT_EQ(sample_keys(still, 8).size(), 1u);
}

}  // namespace
}  // namespace mdk
