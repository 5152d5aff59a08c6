#include "common/structures/temporal_bvh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

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

double cost_in(Bvh bvh, std::span<const Aabb> pose) {
  refit_bvh(bvh, pose);
  return sah_cost(bvh, kConfig);
}

TEST(TemporalBvh, ListsEveryItemOnceWithinTheLeafAndDepthLimits) {
  for (const std::uint32_t count : {1u, 2u, 5u, 100u, 1000u}) {
    const Bvh bvh = build_temporal_bvh(two_poses(count, 1), 2, kConfig);
    std::vector<std::uint32_t> refs = bvh.refs;
    std::sort(refs.begin(), refs.end());
    ASSERT_EQ(refs.size(), count);
    for (std::uint32_t i = 0; i < count; ++i) EXPECT_EQ(refs[i], i);
    std::vector<std::uint32_t> depth(bvh.nodes.size(), 0);
    for (std::size_t n = 0; n < bvh.nodes.size(); ++n) {
      const BvhNode& node = bvh.nodes[n];
      if (node.is_leaf()) {
        EXPECT_LE(node.count, kConfig.max_leaf);
        EXPECT_LE(depth[n], kMaxBvhDepth);
        continue;
      }
      ASSERT_GT(node.first, n);
      depth[node.first] = depth[node.first + 1] = depth[n] + 1;
    }
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

TEST(TemporalBvh, BoxesThatCannotBeToldApartAreHalved) {
  const std::vector<Aabb> boxes(600, Aabb{{1, 1, 1}, {2, 2, 2}});
  const Bvh bvh = build_temporal_bvh(boxes, 2, kConfig);
  EXPECT_EQ(bvh.refs.size(), 300u);
  for (const BvhNode& node : bvh.nodes) EXPECT_LE(node.count, kConfig.max_leaf);
  EXPECT_TRUE(build_temporal_bvh({}, 1, kConfig).nodes.empty());
}

}  // namespace
}  // namespace mdk
