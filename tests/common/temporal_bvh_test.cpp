// Trees for several poses: sound, and better for all of them than a tree of one.

#include <gtest/gtest.h>

#include <random>

#include "common/structures/bvh.h"
#include "common/structures/wide_bvh.h"

namespace mdk {
namespace {

constexpr BvhBuildConfig kConfig{.bins = 32, .max_leaf = 4};

/// Two flocks of small boxes: side by side in x in the first pose; in the second the same boxes are
/// dealt out anew along y.
std::vector<Aabb> two_poses(std::uint32_t count, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0, 1);
  std::vector<Aabb> boxes;
  for (int pose = 0; pose < 2; ++pose)
    for (std::uint32_t i = 0; i < count; ++i) {
      const Vec3f at = pose == 0 ? Vec3f{static_cast<float>(i), unit(random), 0}
                                 : Vec3f{0, static_cast<float>(i * 7 % count), unit(random)};
      boxes.push_back({at, at + Vec3f{0.5f, 0.5f, 0.5f}});
    }
  return boxes;
}

double cost_in(const Bvh& bvh, std::span<const Aabb> pose) {
  WideBvh wide = collapse(bvh);
  refit_wide_bvh(wide, pose);
  return sah_cost(wide);
}

TEST(TemporalBvh, IsSoundInItsFirstPose) {
  for (const std::uint32_t count : {1u, 2u, 5u, 100u, 1000u}) {
    const std::vector<Aabb> boxes = two_poses(count, 1);
    const Bvh bvh = build_temporal_bvh(boxes, 2, kConfig);
    EXPECT_EQ(validate(bvh, std::span(boxes).first(count), kConfig.max_leaf), "");
  }
}

TEST(TemporalBvh, ServesAllItsPosesBetterThanATreeOfOneOfThem) {
  constexpr std::uint32_t kCount = 2000;
  const std::vector<Aabb> boxes = two_poses(kCount, 2);
  const std::span<const Aabb> first = std::span(boxes).first(kCount),
                              second = std::span(boxes).last(kCount);
  const Bvh temporal = build_temporal_bvh(boxes, 2, kConfig);
  const Bvh of_first = build_temporal_bvh(first, 1, kConfig);
  EXPECT_LT(cost_in(temporal, first) + cost_in(temporal, second),
            0.8 * (cost_in(of_first, first) + cost_in(of_first, second)));
}

TEST(TemporalBvh, OfOnePoseIsAsGoodAsTheOrdinaryBuild) {
  constexpr std::uint32_t kCount = 2000;
  const std::vector<Aabb> boxes = two_poses(kCount, 3);
  const std::span<const Aabb> first = std::span(boxes).first(kCount);
  EXPECT_LT(cost_in(build_temporal_bvh(first, 1, kConfig), first),
            1.05 * cost_in(build_bvh(first, kConfig), first));
}

TEST(TemporalBvh, HalvesBoxesThatBinsCannotTellApart) {
  const std::vector<Aabb> boxes(600, Aabb{{1, 1, 1}, {2, 2, 2}});
  const Bvh bvh = build_temporal_bvh(boxes, 2, kConfig);
  EXPECT_EQ(validate(bvh, std::span(boxes).first(300), kConfig.max_leaf), "");
  EXPECT_TRUE(build_temporal_bvh({}, 1, kConfig).nodes.empty());
}

}  // namespace
}  // namespace mdk
