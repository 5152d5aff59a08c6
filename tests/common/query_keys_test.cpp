// The hierarchy over clusters has each of them once, in the box it has at every key, and boxes above
// that hold those below; key poses are what decoding gives.
#include "common/trace/query_keys.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "common/motion/posed_mesh.h"
#include "tests/common/random_boxes.h"

namespace mdk {
namespace {

constexpr std::size_t kCounts[] = {1, 15, 16, 17, 40, 80, 700};
constexpr float kSide = 10;

/// A model of nothing but clusters whose boxes move between two keys.
ModelStorage moving_clusters(std::size_t count, std::uint64_t seed) {
  ModelStorage storage;
  storage.clusters.resize(count);
  storage.key_times = {0, 1};
  storage.clips = {{"move", 0, 2}};
  for (const std::uint64_t key : {0, 1}) {
    const std::vector<Aabb> boxes = test::scattered_boxes(count, kSide, 3, 2 * seed + key);
    Aabb& whole = storage.key_boxes.emplace_back();
    for (const Aabb& box : boxes) whole.extend(box);
    for (const Aabb& box : boxes)
      storage.cluster_world_boxes.push_back(quantize_outward(box, whole));
  }
  return storage;
}

Aabb box_of(const TopBoxes& boxes, std::uint32_t c) {
  return {{boxes.bounds[0][c], boxes.bounds[2][c], boxes.bounds[4][c]},
          {boxes.bounds[1][c], boxes.bounds[3][c], boxes.bounds[5][c]}};
}

class TopTreeOverClusters : public testing::TestWithParam<std::size_t> {};

TEST_P(TopTreeOverClusters, HasEachOnceInABoxThatThoseAboveHold) {
  const std::size_t count = GetParam();
  ModelStorage storage = moving_clusters(count, 7 + count);
  for (Cluster& cluster : storage.clusters) cluster.triangle_count = 1;
  if (count > 2) storage.clusters[2].triangle_count = 0;  // is left out
  const ModelView model = storage.view();
  const TopTree tree(model);
  std::vector<int> seen(count), reached(tree.nodes());
  for (std::uint32_t i = 1; i <= tree.roots(); ++i) ++reached[tree.nodes() - i];
  for (std::uint32_t n = tree.nodes(); n-- > 0;) {
    EXPECT_EQ(reached[n], 1) << "node " << n;
    const TopLinks& links = tree.links()[n];
    ASSERT_GE(links.count, 1u);
    ASSERT_LE(links.count, kTopWidth);
    for (std::uint32_t c = 0; c < links.count; ++c) {
      const std::uint32_t child = links.child[c].index();
      ++(links.child[c].is_leaf() ? seen[child] : reached[child]);
      for (std::uint32_t key = 0; key < model.key_count(); ++key) {
        const TopBoxes* const boxes = tree.boxes() + std::size_t{tree.nodes()} * key;
        const Aabb box = box_of(boxes[n], c);
        if (links.child[c].is_leaf()) {
          EXPECT_EQ(box, model.world_box(key, child));
          continue;
        }
        for (std::uint32_t below = 0; below < tree.links()[child].count; ++below)
          EXPECT_TRUE(box.contains(box_of(boxes[child], below)));
      }
    }
  }
  for (std::size_t c = 0; c < count; ++c)
    EXPECT_EQ(seen[c], model.clusters[c].triangle_count == 0 ? 0 : 1) << "cluster " << c;
}

INSTANTIATE_TEST_SUITE_P(OfAnyNumber, TopTreeOverClusters, testing::ValuesIn(kCounts));

}  // namespace
}  // namespace mdk
