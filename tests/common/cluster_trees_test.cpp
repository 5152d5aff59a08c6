// Blocks hold each triangle once; validate() sees what is wrong.
#include "common/trace/cluster_trees.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace mdk {
namespace {

using testing::HasSubstr;

/// Two clusters of 40 and 5 triangles in a row, for all times.
ModelStorage two_clusters() {
  ModelStorage storage;
  storage.vertex_count = 47;
  storage.key_times = {0};
  storage.clips = {{"still", 0, 1}};
  for (std::uint32_t i = 0; i < 47; ++i)
    storage.poses.key_positions.push_back({static_cast<float>(i), static_cast<float>(i % 2), 0});
  const Aabb frame{{0, 0, 0}, {47, 1, 1}};
  for (std::uint32_t i = 0; i < 45; ++i) {
    storage.triangles.push_back({{i, i + 1, i + 2}});
    const auto x = static_cast<float>(i);
    storage.fuzzy_boxes.push_back(quantize_outward({{x, 0, 0}, {x + 2, 1, 0}}, frame));
  }
  storage.clusters.resize(2);
  storage.clusters[0].triangle_count = storage.clusters[1].first_triangle = 40;
  storage.clusters[1].triangle_count = 5;
  storage.segments.resize(1);
  storage.fuzzy_trees.resize(2);
  for (FuzzyTree& tree : storage.fuzzy_trees) tree.local_box = frame;
  return storage;
}

TEST(ClusterTrees, HoldEachTriangleOnce) {
  const ModelStorage storage = two_clusters();
  const ModelView model = storage.view();
  const ClusterTrees trees = build_cluster_trees(model, 0);
  EXPECT_EQ(validate(trees, model), "");
  EXPECT_GE(trees.blocks.size(), 4u);
}

TEST(ClusterTrees, ValidateSeesWhatIsWrong) {
  const ModelStorage storage = two_clusters();
  const ModelView model = storage.view();
  const ClusterTrees sound = build_cluster_trees(model, 0);
  const auto verdict = [&](auto&& damage) {
    ClusterTrees trees = sound;
    damage(trees);
    return validate(trees, model);
  };
  const auto blocks_verdict = [&](auto&& damage) {
    std::vector<TriangleBlock> blocks = sound.blocks;
    damage(blocks);
    return validate(blocks, model.triangles);
  };
  EXPECT_THAT(verdict([](ClusterTrees& t) { t.blocks.push_back(t.blocks[0]); }),
              HasSubstr("blocks without leaves"));
  EXPECT_THAT(verdict([](ClusterTrees& t) { ++t.first_leaf[1]; }), HasSubstr("without blocks"));
  EXPECT_THAT(verdict([](ClusterTrees& t) { std::swap(t.blocks[0], t.blocks[1]); }),
              HasSubstr("unlike its block"));
  EXPECT_THAT(verdict([](ClusterTrees& t) { t.trees.pop_back(); }), HasSubstr("differ in number"));
  EXPECT_THAT(blocks_verdict([](auto& blocks) { blocks.pop_back(); }), HasSubstr("in no block"));
  EXPECT_THAT(blocks_verdict([](auto& blocks) { blocks.push_back(blocks[0]); }),
              HasSubstr("a second time"));
  EXPECT_THAT(blocks_verdict([](auto& blocks) { ++blocks[0].corner[1][0]; }),
              HasSubstr("another triangle"));
  EXPECT_THAT(blocks_verdict([](auto& blocks) { blocks[0].triangle[0] = 45; }),
              HasSubstr("not there"));
  EXPECT_THAT(blocks_verdict([](auto& blocks) { blocks[0].count = 0; }), HasSubstr("wrong number"));
}

/// Every corner of every triangle mapped for itself.
Aabb local_box(const Affine3d& map, const Triangle& triangle, const std::vector<Vec3f>& positions) {
  Aabbd box;
  for (const std::uint32_t v : triangle.v) {
    const Vec3d p = map.point(to_double(positions[v]));
    if (!(length(p) < std::numeric_limits<float>::max())) return {{0, 0, 0}, {0, 0, 0}};
    box.extend(p);
  }
  return round_outward(box);
}

TEST(LocalBoxes, AreThoseOfEachTriangleAlone) {
  ModelStorage storage = two_clusters();
  for (std::uint32_t i = 0; i < 45; ++i) storage.triangles[i] = {{i, (i * 7 + 3) % 47, 46 - i}};
  const ModelView model = storage.view();
  LocalBoxes boxes(model);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> entry(-2, 2);
  for (int round = 0; round < 20; ++round) {
    std::vector<Vec3f> positions;
    for (int i = 0; i < 47; ++i)
      positions.push_back(to_float(Vec3d{entry(random), entry(random), entry(random)}));
    if (round % 4 == 1) positions[5].y = std::numeric_limits<float>::quiet_NaN();
    if (round % 4 == 2) positions[9].z = std::numeric_limits<float>::infinity();
    if (round % 4 == 3) positions[11].x = -std::numeric_limits<float>::max();
    for (std::size_t c = 0; c < 2; ++c) {
      Affine3d map;
      for (auto& row : map.m)
        for (double& m : row) m = entry(random);
      const std::span<const Aabb> found = boxes.find(c, map, positions.data());
      ASSERT_EQ(found.size(), model.clusters[c].triangle_count);
      for (std::size_t i = 0; i < found.size(); ++i)
        EXPECT_EQ(found[i],
                  local_box(map, model.triangles[model.clusters[c].first_triangle + i], positions));
    }
  }
}

}  // namespace
}  // namespace mdk
