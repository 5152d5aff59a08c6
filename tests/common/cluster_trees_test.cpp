// Blocks hold each triangle once; validate() sees what is wrong.
#include "common/trace/cluster_trees.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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

}  // namespace
}  // namespace mdk
