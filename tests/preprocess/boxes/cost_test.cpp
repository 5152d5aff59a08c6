#include "preprocess/boxes/cost.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "tests/preprocess/moving_meshes.h"

namespace mdk {
namespace {

/// The edges of a box with extent e, carried back to the world: columns of L^-1 times e.
std::vector<Vec3d> world_edges(const Affine3d& map, const Vec3d& e) {
  const Vec3d c0 = map.column(0), c1 = map.column(1), c2 = map.column(2);
  const double det = map.determinant();
  const Vec3d rows[3] = {cross(c1, c2) * (1 / det), cross(c2, c0) * (1 / det),
                         cross(c0, c1) * (1 / det)};  // rows of the inverse
  std::vector<Vec3d> edges;
  for (std::size_t j = 0; j < 3; ++j)
    edges.push_back(Vec3d{rows[0][j], rows[1][j], rows[2][j]} * e[j]);
  return edges;
}

TEST(Cost, WorldAreaIsTheParallelepipedsArea) {
  std::mt19937 random(21);
  for (int round = 0; round < 100; ++round) {
    const Affine3d map = random_affine(random);
    const Vec3d e = random_point(random, 0.5) + Vec3d{1, 1, 1};
    const std::vector<Vec3d> edge = world_edges(map, e);
    const double area = 2 * (length(cross(edge[0], edge[1])) + length(cross(edge[1], edge[2])) +
                             length(cross(edge[2], edge[0])));
    EXPECT_NEAR(world_area_weights(map).area(e), area, 1e-9 * area);
  }
}

TEST(Cost, MappingSmallerDoesNotMakeABoxCheaper) {
  Affine3d shrinking;
  for (int i = 0; i < 3; ++i) shrinking.m[i][i] = 0.01;
  const Vec3d world{1, 2, 3}, local = world * 0.01;
  EXPECT_NEAR(world_area_weights(shrinking).area(local), AreaWeights{}.area(world), 1e-9);
}

TEST(Cost, OneNearlySingularKeyInManyHardlyCounts) {
  std::vector<Affine3d> maps(200);
  const std::vector<double> areas(200, 6.0);
  const double before = mean_area_weights(maps, areas).xy;
  maps[77].m[0][0] = 1e-7;
  const double after = mean_area_weights(maps, areas).xy;
  EXPECT_GE(after, before);
  EXPECT_LT(after, 1.05 * before);
}

TEST(Cost, KeysAtWhichTheModelHasNoAreaAreLeftOut) {
  const std::vector<Affine3d> maps(4);
  const std::vector<double> all(4, 2.0), some{2.0, 0.0, 2.0, 0.0}, none(4, 0.0);
  EXPECT_DOUBLE_EQ(mean_area_weights(maps, some).yz, mean_area_weights(maps, all).yz);
  EXPECT_TRUE(std::isfinite(mean_area_weights(maps, none).yz));
}

TEST(Cost, GrowsWithEveryBoxAndEveryCluster) {
  ClusterWork work;
  work.hit_probability = 0.5;
  work.fuzzy_boxes.add(Aabb{{0, 0, 0}, {1, 1, 1}});
  const double one = expected_work(std::vector{work});
  ClusterWork more = work;
  more.fuzzy_boxes.add(Aabb{{0, 0, 0}, {0.5f, 0, 0.25f}});
  EXPECT_GT(expected_work(std::vector{more}), one);
  ClusterWork empty;
  empty.hit_probability = 0.1;
  EXPECT_GT(expected_work(std::vector{work, empty}), one);
  EXPECT_DOUBLE_EQ(fuzzy_area(std::vector{work, empty}), fuzzy_area(std::vector{work}));
}

TEST(Cost, WinsorisedMeanIsTheMeanWithoutOutliers) {
  EXPECT_DOUBLE_EQ(winsorised_mean(std::vector<double>{1, 2, 3, 4, 5}), 3);
  EXPECT_DOUBLE_EQ(winsorised_mean(std::vector<double>{1, 1, 1, 1e9}), (3 + 8) / 4.0);
  EXPECT_DOUBLE_EQ(winsorised_mean({}), 0);
}

}  // namespace
}  // namespace mdk
