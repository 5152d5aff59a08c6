// Welding and the checks on a pose sequence.
#include "common/motion/pose_sequence.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/base/parallel.h"
#include "tests/common/random_rig.h"

namespace mdk {
namespace {

using testing::ElementsAre;

/// Two keys in one clip; `from` and `to`: where each vertex stands.
PoseSequence two_keys(const std::vector<Vec3f>& from, const std::vector<Vec3f>& to,
                      const std::vector<Triangle>& triangles) {
  PoseSequence s;
  s.vertex_count = static_cast<std::uint32_t>(from.size());
  s.triangles = triangles;
  s.clips = {{"clip", 0, 2}};
  s.key_times = {0, 1};
  s.positions.assign(from.begin(), from.end());
  s.positions.insert(s.positions.end(), to.begin(), to.end());
  s.appearance.materials.push_back({});
  s.appearance.triangle_materials.assign(triangles.size(), 0);
  return s;
}

TEST(WeldVertices, JoinsOnlyWhatStaysTogetherAtEveryKey) {
  // Vertices 0, 2 and 4 start together; 4 goes its own way.
  PoseSequence s =
      two_keys({{0, 0, 0}, {1, 0, 0}, {0, 0, 0}, {0, 1, 0}, {0, 0, 0}},
               {{0, 0, 1}, {1, 0, 1}, {0, 0, 1}, {0, 1, 1}, {0, 0, 2}}, {{{0, 1, 3}}, {{2, 3, 4}}});
  weld_vertices(s, {});
  check_consistency(s);
  EXPECT_THAT(s.triangles, ElementsAre(Triangle{{0, 1, 2}}, Triangle{{0, 2, 3}}));
  EXPECT_THAT(s.pose(0), ElementsAre(Vec3f{0, 0, 0}, Vec3f{1, 0, 0}, Vec3f{0, 1, 0}, Vec3f{}));
  EXPECT_THAT(s.pose(1),
              ElementsAre(Vec3f{0, 0, 1}, Vec3f{1, 0, 1}, Vec3f{0, 1, 1}, Vec3f{0, 0, 2}));
}

TEST(WeldVertices, DropsUnusedVerticesAndOrdersTheRestByFirstUse) {
  PoseSequence s = two_keys({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}},
                            {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}, {{{3, 1, 2}}});
  weld_vertices(s, {});
  EXPECT_THAT(s.triangles, ElementsAre(Triangle{{0, 1, 2}}));
  EXPECT_THAT(s.pose(1), ElementsAre(Vec3f{3, 0, 0}, Vec3f{1, 0, 0}, Vec3f{2, 0, 0}));
}

TEST(WeldVertices, KeepsSmoothingGroupsApart) {
  const std::vector<Vec3f> at = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}};
  const std::vector<Triangle> triangles = {{{0, 1, 2}}, {{3, 2, 1}}};
  PoseSequence split = two_keys(at, at, triangles), joined = split;
  weld_vertices(split, std::vector<std::uint64_t>{5, 5, 5, 6});
  EXPECT_EQ(split.vertex_count, 4u);
  weld_vertices(joined, std::vector<std::uint64_t>{5, 5, 5, 5});
  EXPECT_EQ(joined.vertex_count, 3u);
}

TEST(WeldVertices, NegativeZeroIsZero) {
  const std::vector<Vec3f> at = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-0.0f, 0, -0.0f}};
  PoseSequence s = two_keys(at, at, {{{0, 1, 2}}, {{3, 2, 1}}});
  weld_vertices(s, {});
  EXPECT_EQ(s.vertex_count, 3u);
}

TEST(WeldVertices, NeighbouringFloatsStayApart) {
  const float above_one = std::nextafter(1.0f, 2.0f);
  const std::vector<Vec3f> at = {{1, 0, 0}, {above_one, 0, 0}, {0, 1, 0}};
  PoseSequence s = two_keys(at, at, {{{0, 1, 2}}});
  weld_vertices(s, {});
  EXPECT_EQ(s.vertex_count, 3u);
}

/// Vertices on a coarse grid, so that many coincide; seed printed on failure.
PoseSequence random_sequence(unsigned seed, std::uint32_t vertices, std::uint32_t triangles) {
  std::mt19937 random(seed);
  const auto below = [&](std::uint32_t n) { return static_cast<std::uint32_t>(random() % n); };
  std::vector<Vec3f> from, to;
  for (std::uint32_t i = 0; i < vertices; ++i) {
    from.push_back({static_cast<float>(below(4)), static_cast<float>(below(4)), 0});
    to.push_back({static_cast<float>(below(3)), 0, static_cast<float>(below(2))});
  }
  std::vector<Triangle> list;
  for (std::uint32_t i = 0; i < triangles; ++i)
    list.push_back({{below(vertices), below(vertices), below(vertices)}});
  return two_keys(from, to, list);
}

TEST(WeldVertices, EveryCornerStaysWhereItWasAtEveryKey) {
  const unsigned seed = 7;
  SCOPED_TRACE("seed " + std::to_string(seed));
  const PoseSequence before = random_sequence(seed, 5000, 4000);
  PoseSequence after = before;
  weld_vertices(after, {});
  check_consistency(after);
  EXPECT_LE(after.vertex_count, 4u * 4 * 3 * 2);
  for (std::uint32_t key = 0; key < 2; ++key)
    for (std::size_t t = 0; t < before.triangles.size(); ++t)
      for (int c = 0; c < 3; ++c)
        ASSERT_EQ(after.pose(key)[after.triangles[t].v[c]],
                  before.pose(key)[before.triangles[t].v[c]]);
}

TEST(WeldVertices, DoesNotDependOnTheNumberOfThreads) {
  PoseSequence one = random_sequence(11, 20000, 9000), many = one;
  {
    const ThreadLimit limit(1);
    weld_vertices(one, {});
  }
  const ThreadLimit limit(4);
  weld_vertices(many, {});
  EXPECT_EQ(one.triangles, many.triangles);
  EXPECT_EQ(one.positions, many.positions);
}

TEST(LowestEqualPaths, IsExactEvenIfEveryHashCollides) {
  const unsigned seed = 3;
  SCOPED_TRACE("seed " + std::to_string(seed));
  const PoseSequence s = random_sequence(seed, 400, 1);
  std::vector<std::uint64_t> groups(400);
  for (std::size_t i = 0; i < groups.size(); ++i) groups[i] = i % 2;
  const std::vector<std::uint64_t> collisions(400, 0);
  const std::vector<std::uint32_t> lowest = lowest_equal_paths(s, groups, collisions);
  for (std::uint32_t i = 0; i < 400; ++i) {
    std::uint32_t expected = 0;
    while (groups[expected] != groups[i] || !(s.pose(0)[expected] == s.pose(0)[i]) ||
           !(s.pose(1)[expected] == s.pose(1)[i]))
      ++expected;
    ASSERT_EQ(lowest[i], expected) << i;
  }
}

TEST(CheckConsistency, NamesWhatDoesNotFit) {
  const PoseSequence good = random_sequence(1, 10, 5);
  check_consistency(good);
  const std::vector<std::pair<std::string, std::function<void(PoseSequence&)>>> faults = {
      {"no clip", [](PoseSequence& s) { s.clips.clear(); }},
      {"clip 1 does not start where the last one ended, or is empty",
       [](PoseSequence& s) {
         s.clips.push_back({"x", 2, 0});
       }},
      {"clip 0 does not start where the last one ended",
       [](PoseSequence& s) { s.clips[0].first_key = 1; }},
      {"clip 0 reaches past the last key", [](PoseSequence& s) { s.clips[0].key_count = 3; }},
      {"clips: they do not cover every key", [](PoseSequence& s) { s.clips[0].key_count = 1; }},
      {"key_times: key 1", [](PoseSequence& s) { s.key_times[1] = 0; }},
      {"key_times: key 0", [](PoseSequence& s) { s.key_times[0] = -1; }},
      {"position", [](PoseSequence& s) { s.positions.pop_back(); }},
      {"triangle 4 names vertex 10 of 10", [](PoseSequence& s) { s.triangles[4].v[2] = 10; }},
      {"materials: 0", [](PoseSequence& s) { s.appearance.materials.clear(); }},
      {"triangle_materials: 4 of them, not 5",
       [](PoseSequence& s) { s.appearance.triangle_materials.pop_back(); }},
      {"triangle 0 names material 1 of 1",
       [](PoseSequence& s) { s.appearance.triangle_materials[0] = 1; }},
      {"corner_texcoords: 14 of them, not 15",
       [](PoseSequence& s) { s.appearance.corner_texcoords.resize(14); }},
      {"corner_colors: 16 of them, not 15",
       [](PoseSequence& s) { s.appearance.corner_colors.resize(16); }},
      {"material 0 names texture 0 of 0",
       [](PoseSequence& s) { s.appearance.materials[0].texture = 0; }},
      {"texture 0 reaches past the last texel",
       [](PoseSequence& s) {
         s.appearance.textures.push_back({2, 2, 0});
       }},
  };
  for (const auto& [words, damage] : faults) {
    PoseSequence bad = good;
    damage(bad);
    try {
      check_consistency(bad);
      ADD_FAILURE() << words;
    } catch (const std::logic_error& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr(words));
    }
  }
}

/// Vertices 1 and 4 of the rig are computed from the same numbers.
PoseSequence rigged_sequence() {
  PoseSequence s;
  s.vertex_count = 6;
  s.triangles = {{{5, 4, 2}}, {{1, 2, 3}}};
  s.clips = {{"clip", 0, 3}};
  s.key_times = {0, 1, 2};
  s.appearance.materials.push_back({});
  s.appearance.triangle_materials = {0, 0};
  s.rig = random_rig({.vertices = 6}, 21);
  const std::vector<std::uint32_t> twins = {0, 1, 2, 3, 1, 5};
  s.rig = select_vertices(*s.rig, twins);
  return s;
}

TEST(WeldVertices, JoinsVerticesComputedFromTheSameNumbers) {
  PoseSequence s = rigged_sequence();
  weld_vertices(s, {});
  EXPECT_EQ(s.vertex_count, 4u);
  EXPECT_THAT(s.triangles, ElementsAre(Triangle{{0, 1, 2}}, Triangle{{1, 2, 3}}));
}

TEST(WeldVertices, KeepsRigAndPositionsInStep) {
  PoseSequence s = rigged_sequence();
  decode_positions(s);
  const std::vector<Vec3f> before(s.pose(2).begin(), s.pose(2).end());
  weld_vertices(s, {});
  check_consistency(s);
  EXPECT_THAT(s.pose(2), ElementsAre(before[5], before[1], before[2], before[3]));
  const PositionList positions = s.positions;
  decode_positions(s);
  EXPECT_EQ(s.positions, positions);
}

TEST(SelectVertices, ReordersPosesAndRenumbersTriangles) {
  PoseSequence s = two_keys({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}},
                            {{0, 0, 1}, {1, 0, 1}, {2, 0, 1}, {3, 0, 1}}, {{{3, 1, 2}}});
  const std::vector<std::uint32_t> kept = {2, 3, 1};
  select_vertices(s, kept);
  check_consistency(s);
  EXPECT_THAT(s.triangles, ElementsAre(Triangle{{1, 2, 0}}));
  EXPECT_THAT(s.pose(1), ElementsAre(Vec3f{2, 0, 1}, Vec3f{3, 0, 1}, Vec3f{1, 0, 1}));
}

}  // namespace
}  // namespace mdk
