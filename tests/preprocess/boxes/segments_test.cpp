// Time segments: where the cuts fall, that every segment's boxes hold at all its times, and that
// the dial between one segment and one per interval turns.
#include "preprocess/boxes/segments.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <random>

#include "common/base/parallel.h"
#include "common/math/affine3.h"
#include "common/motion/posed_mesh.h"
#include "preprocess/pipeline.h"
#include "tests/preprocess/moving_meshes.h"
#include "tests/preprocess/whole_sequence.h"

namespace mdk {
namespace {

constexpr std::uint32_t kStretchKeys = 60;

/// A cartoon's take: a sheet that breathes a little, and for keys 24 to 36 is drawn out unevenly.
PoseSequence stretch() {
  const Mesh mesh = curved_sheet(16);
  PoseSequence sequence = make_sequence(mesh, kStretchKeys, [&](std::uint32_t k, std::uint32_t i) {
    const Vec3d v = mesh.vertices[i];
    const double breath = 0.02 * std::sin(0.7 * k + 3 * v.x);
    const double take =
        k > 24 && k < 36 ? std::pow(std::sin((k - 24) * std::acos(-1.0) / 12), 2) : 0;
    const Vec3d drawn{v.x * (1 + take * (1 + std::sin(9 * v.y))),
                      v.y + take * 1.5 * v.y * v.y * v.y, v.z + 0.4 * take * std::sin(20 * v.x)};
    return rigid_motion({0, 0, 1}, 0.02 * k, {0.05 * k, 0, 0}).point(drawn + Vec3d{0, 0, breath});
  });
  return sequence;
}

DecomposeResult baked(const PoseSequence& sequence, std::uint32_t segments,
                      std::uint32_t clusters = 4) {
  DecomposeOptions options;
  options.clusters = clusters;
  options.segments = segments;
  SilentProgress silent;
  return decompose(sequence, options, silent);
}

/// Corners outside their boxes at a moment, in every segment that has it.
std::size_t escapes(const ModelView& model, const KeyInterval& at) {
  PosedMesh mesh(model);
  mesh.set_time(at);
  std::size_t outside = 0, looked_at = 0;
  for (std::uint32_t s = 0; s < model.segment_count(); ++s) {
    if (at.key0 < model.segments[s].first_key || at.key1 > model.segments[s].last_key) continue;
    ++looked_at;
    for (std::uint32_t c = 0; c < model.cluster_count(); ++c) {
      const Affine3d map =
          interpolate(model.key_maps(at.key0)[c], model.key_maps(at.key1)[c], at.s);
      const Cluster& cluster = model.clusters[c];
      for (std::uint32_t t = cluster.first_triangle;
           t < cluster.first_triangle + cluster.triangle_count; ++t)
        for (const std::uint32_t v : model.triangles[t].v) {
          const Aabb box = model.fuzzy_box(s, c, t);
          outside += !Aabbd{to_double(box.lo), to_double(box.hi)}.contains(
              map.point(to_double(mesh.positions()[v])));
        }
    }
  }
  EXPECT_GE(looked_at, 1u);
  return outside;
}

TEST(Segments, TheirBoxesHoldAtEveryTimeAndAtTheCuts) {
  for (std::uint32_t seed = 90; seed < 96; ++seed) {
    std::printf("seed %u\n", seed);
    std::mt19937 random(seed);
    const DecomposeResult result = baked(wild_motion(seed, 12 + seed % 3), 2 + seed % 4, 3);
    const ModelView model = result.model.view();
    ASSERT_EQ(model.segment_count(), 2 + seed % 4);
    std::size_t outside = 0;
    std::uniform_real_distribution<float> any_s(0, 1);
    for (int i = 0; i < 1000; ++i)
      for (const Segment& keys : smallest_segments(model.clips)) {
        if (i == 0) outside += escapes(model, at_key(keys.first_key));
        if (i == 0) outside += escapes(model, at_key(keys.last_key));
        outside += escapes(model, {keys.first_key, keys.last_key, any_s(random)});
        if (i % 10 != 0) continue;
        outside += escapes(model, {keys.first_key, keys.last_key, 0x1.fffffep-1f});
        outside += escapes(model, {keys.first_key, keys.last_key, 0x1p-24f});
      }
    EXPECT_EQ(outside, 0u);
  }
}

TEST(Segments, TheSegmentOfAMomentHoldsBothItsKeys) {
  for (const std::uint32_t count : {1u, 3u, 7u, 100u}) {
    const DecomposeResult result = baked(wild_motion(97, 17), count, 2);
    const ModelView model = result.model.view();
    const auto expect_held = [&](const KeyInterval& at) {
      const Segment& segment = model.segments[segment_of(model, at)];
      EXPECT_LE(segment.first_key, at.key0);
      EXPECT_GE(segment.last_key, at.key1);
    };
    for (std::uint32_t key = 0; key < model.key_count(); ++key) expect_held(at_key(key));
    for (const Segment& keys : smallest_segments(model.clips))
      expect_held({keys.first_key, keys.last_key, 0.5f});
  }
}

TEST(Segments, AreAsManyAsAskedForOrAsThereCanBeWithANote) {
  const PoseSequence sequence = wild_motion(98, 14);  // clips of 7 keys: 12 intervals
  for (std::uint32_t count = 1; count <= 12; ++count) {
    const DecomposeResult result = baked(sequence, count, 2);
    EXPECT_EQ(result.model.segments.size(), count);
    EXPECT_TRUE(result.stats.notes.empty());
  }
  const DecomposeResult most = baked(sequence, 13, 2);
  EXPECT_EQ(most.model.segments, smallest_segments(sequence.clips));
  ASSERT_EQ(most.stats.notes.size(), 1u);
  EXPECT_NE(most.stats.notes[0].find("it got 12"), std::string::npos) << most.stats.notes[0];
}

TEST(Segments, OfLongAnimationsAreAsManyAsAskedFor) {
  const Mesh mesh = curved_sheet(2);
  const PoseSequence sequence = make_sequence(mesh, 700, [&](std::uint32_t k, std::uint32_t i) {
    const Vec3d v = mesh.vertices[i];
    return Vec3d{v.x, v.y, v.z + 0.1 * std::sin(0.02 * k * (1 + v.x))};
  });
  const ClusterMembers members = whole_members(sequence);
  const std::vector<Affine3f> maps(700);
  for (const std::uint32_t count : {2u, 50u, 65u, 200u, 349u, 350u, 698u}) {
    const std::vector<Segment> segments =
        choose_segments(sequence, members, maps, count, BetweenKeys::kBound);
    ASSERT_EQ(segments.size(), count);
    EXPECT_EQ(segments.front().first_key, 0u);
    EXPECT_EQ(segments.back().last_key, 699u);
    for (std::size_t i = 1; i < segments.size(); ++i)
      EXPECT_EQ(segments[i].first_key, segments[i - 1].last_key);
  }
}

TEST(Segments, SetAnExtremeStretchApart) {
  const DecomposeResult result = baked(stretch(), 0);
  ASSERT_GE(result.model.segments.size(), 3u);
  // Nothing outside the take shares a segment with its height.
  for (const Segment& segment : result.model.segments)
    if (segment.first_key <= 30 && segment.last_key >= 30) {
      EXPECT_GE(segment.first_key, 23u);
      EXPECT_LE(segment.last_key, 37u);
    }
}

TEST(Segments, CostLessTheMoreThereAreAndAutomaticSpendsWhereItGainsMuch) {
  const PoseSequence sequence = stretch();
  double before = baked(sequence, 1).stats.sah_cost;
  const double one = before;
  for (const std::uint32_t count : {2u, 4u, 8u, 16u, kStretchKeys - 1}) {
    const double cost = baked(sequence, count).stats.sah_cost;
    EXPECT_LT(cost, before) << count;
    before = cost;
  }
  const double most = before;
  const DecomposeResult automatic = baked(sequence, 0);
  std::printf("cost: one %.2f, automatic %.2f with %zu, one per interval %.2f\n", one,
              automatic.stats.sah_cost, automatic.model.segments.size(), most);
  EXPECT_LT(automatic.stats.sah_cost - most, 0.35 * (one - most));
  EXPECT_LT(automatic.model.segments.size(), kStretchKeys / 3);
}

TEST(Segments, AutomaticMakesOneOfWhatMovesStiffly) {
  EXPECT_EQ(baked(independent_parts(3, 40), 0, 3).model.segments.size(), 1u);
}

TEST(Segments, ClipsApartAreCutBetweenThem) {
  // A calm clip and a wild one: the cheapest single cut is where one ends.
  PoseSequence sequence = stretch();
  for (std::uint32_t k = 0; k < 30; ++k) {
    const std::span<const Vec3f> calm = sequence.pose(k % 2);
    std::copy(calm.begin(), calm.end(), sequence.pose(k).begin());
  }
  sequence.clips = {{"calm", 0, 30}, {"wild", 30, 30}};
  for (std::uint32_t k = 30; k < 60; ++k) sequence.key_times[k] = (k - 30) / 30.0;
  const std::vector<Segment> segments = baked(sequence, 2).model.segments;
  EXPECT_EQ(segments, (std::vector<Segment>{{0, 29}, {30, 59}}));
}

TEST(Segments, AreTheSameOnAnyNumberOfThreads) {
  std::vector<unsigned char> bytes[2];
  for (const int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    bytes[threads - 1] = model_bytes(baked(stretch(), 0).model);
  }
  EXPECT_EQ(bytes[0], bytes[1]);
}

constexpr double kInf = std::numeric_limits<double>::infinity();

RunCosts random_costs(std::uint32_t blocks, std::uint32_t longest, std::mt19937& random) {
  RunCosts costs(blocks, longest);
  std::uniform_real_distribution<double> any(0, 1);
  for (double& value : costs.values) value = any(random);
  return costs;
}

/// Cost of the runs that start where bit b - 1 of `cuts` is set for block b, and at block 0;
/// nothing where one is too long.
std::optional<double> cost_of(const RunCosts& costs, std::uint32_t cuts, double price) {
  double sum = 0;
  std::uint32_t first = 0;
  for (std::uint32_t b = 1; b <= costs.blocks; ++b) {
    if (b < costs.blocks && (cuts >> (b - 1) & 1u) == 0) continue;
    if (b - first > costs.longest) return std::nullopt;
    sum += costs.of(first, b - 1) + price;
    first = b;
  }
  return sum;
}

/// The least cost of all partitions, or of those into `count` runs.
double min_cost(const RunCosts& costs, double price, std::optional<std::uint32_t> count) {
  double least = kInf;
  for (std::uint32_t cuts = 0; cuts < 1u << (costs.blocks - 1); ++cuts) {
    if (count && static_cast<std::uint32_t>(std::popcount(cuts)) + 1 != *count) continue;
    if (const auto cost = cost_of(costs, cuts, price)) least = std::min(least, *cost);
  }
  return least;
}

std::uint32_t cuts_of(const std::vector<std::uint32_t>& runs) {
  std::uint32_t cuts = 0;
  for (const std::uint32_t first : runs)
    if (first > 0) cuts |= 1u << (first - 1);
  return cuts;
}

TEST(Partition, IsTheBestOfAllThereAre) {
  constexpr unsigned kSeed = 1511;
  std::printf("seed %u\n", kSeed);
  std::mt19937 random(kSeed);
  for (int i = 0; i < 300; ++i) {
    const std::uint32_t blocks = 1 + i % 11, longest = 1 + i % 7 % blocks;
    const RunCosts costs = random_costs(blocks, longest, random);
    for (const double price : {0.0, 0.1, 0.5, 3.0}) {
      const auto runs = cheapest_runs(costs, price);
      ASSERT_EQ(runs.front(), 0u);
      EXPECT_NEAR(cost_of(costs, cuts_of(runs), price).value_or(kInf),
                  min_cost(costs, price, std::nullopt), 1e-12);
    }
  }
}

TEST(Partition, IntoAGivenNumberIsTheBestOfThose) {
  constexpr unsigned kSeed = 1512;
  std::printf("seed %u\n", kSeed);
  std::mt19937 random(kSeed);
  for (int i = 0; i < 200; ++i) {
    const std::uint32_t blocks = 1 + i % 11, longest = 1 + i % 7 % blocks;
    const RunCosts costs = random_costs(blocks, longest, random);
    for (std::uint32_t count = (blocks + longest - 1) / longest; count <= blocks; ++count) {
      const auto runs = cheapest_runs_of_count(costs, count);
      ASSERT_EQ(runs.size(), count);
      ASSERT_EQ(runs.front(), 0u);
      EXPECT_NEAR(cost_of(costs, cuts_of(runs), 0).value_or(kInf), min_cost(costs, 0, count),
                  1e-12);
    }
  }
}

TEST(Partition, ADearerRunNeverMakesMoreOfThem) {
  std::mt19937 random(1513);
  const RunCosts costs = random_costs(40, 40, random);
  std::size_t before = 40;
  for (const double price : {0.0, 0.01, 0.05, 0.2, 1.0, 100.0}) {
    const std::size_t runs = cheapest_runs(costs, price).size();
    EXPECT_LE(runs, before) << price;
    before = runs;
  }
  EXPECT_EQ(before, 1u);
}

}  // namespace
}  // namespace mdk
