// Values over time, against numbers worked out by hand (glTF 2.0 appendix C).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "common/base/parallel.h"
#include "tests/formats/gltf_builder.h"
#include "tests/formats/gltf_expect.h"

namespace mdk::test {
namespace {

using testing::DoubleNear;
using testing::ElementsAre;
using testing::Pointwise;

const float kHalf = std::sqrt(0.5f);

/// One triangle on node 0, moved by one channel.
class Moved {
 public:
  Moved() { b.add("nodes", "{\"mesh\": " + std::to_string(b.triangle_mesh()) + "}"); }

  void animate(const std::string& path, const std::vector<float>& times,
               const std::vector<float>& values, const std::string& interpolation) {
    const int input = b.accessor<float>("SCALAR", times);
    const int output = b.accessor<float>(path == "rotation" ? "VEC4" : "VEC3", values);
    b.animation(0, path, input, output, interpolation);
  }

  GltfBuilder b;
};

/// Where (0,0,0), (1,0,0) and (0,1,0) go under a turn about z.
std::vector<Vec3f> turned_about_z(double degrees) {
  const double a = degrees * std::numbers::pi / 180;
  const auto c = static_cast<float>(std::cos(a)), s = static_cast<float>(std::sin(a));
  return {{0, 0, 0}, {c, s, 0}, {-s, c, 0}};
}

std::vector<Vec3f> shifted(float x, float y, float z) {
  return {{x, y, z}, {x + 1, y, z}, {x, y + 1, z}};
}

TEST(GltfAnimation, LinearTranslationRunsStraightBetweenKeys) {
  Moved m;
  m.animate("translation", {0, 1, 2}, {0, 0, 0, 4, 0, 0, 4, 8, 0}, "LINEAR");
  const PoseSequence s = read_built(m.b, 4).sequence;
  ASSERT_EQ(s.key_count(), 9u);
  expect_pose(s, 1, shifted(1, 0, 0));
  expect_pose(s, 4, shifted(4, 0, 0));
  expect_pose(s, 5, shifted(4, 2, 0));
  expect_pose(s, 8, shifted(4, 8, 0));
}

TEST(GltfAnimation, StepHoldsAValueUntilTheNextKeyIsReached) {
  Moved m;
  // 1 / 30 s as a float is a little more than 1 / 30: the grid must reach it all the same.
  m.animate("translation", {0, 1.0f / 30, 3.0f / 30}, {1, 0, 0, 2, 0, 0, 3, 0, 0}, "STEP");
  const PoseSequence s = read_built(m.b, 30).sequence;
  ASSERT_EQ(s.key_count(), 4u);
  expect_pose(s, 0, shifted(1, 0, 0));
  expect_pose(s, 1, shifted(2, 0, 0));
  expect_pose(s, 2, shifted(2, 0, 0));
  expect_pose(s, 3, shifted(3, 0, 0));
}

TEST(GltfAnimation, CubicSplineIsTheHermiteCurveOfValuesAndScaledTangents) {
  Moved m;
  // Two keys 2 s apart; per key: in-tangent, value, out-tangent. In x: 1 with slope 3, to 5 with
  // slope -1. At s = 1/4: h00 = 27/32, h10 = 9/64, h01 = 5/32, h11 = -3/64.
  m.animate("translation", {0, 2}, {9, 9, 9, 1, 0, 0, 3, 0, 0, /**/ -1, 0, 0, 5, 0, 0, 9, 9, 9},
            "CUBICSPLINE");
  const PoseSequence s = read_built(m.b, 2).sequence;
  ASSERT_EQ(s.key_count(), 5u);
  expect_pose(s, 0, shifted(1, 0, 0));
  const float quarter = 1 * 27.0f / 32 + 2 * 3 * 9.0f / 64 + 5 * 5.0f / 32 + 2 * -1 * -3.0f / 64;
  expect_pose(s, 1, shifted(quarter, 0, 0));
  expect_pose(s, 2, shifted(0.5f + 2 * 3 / 8.0f + 2.5f + 2 * -1 * -1 / 8.0f, 0, 0));
  expect_pose(s, 4, shifted(5, 0, 0));
}

TEST(GltfAnimation, RotationTurnsEvenlyAlongTheArc) {
  Moved m;
  // 0 to 90 degrees about z: a third of the time is a third of the angle, as straight-line
  // interpolation would not give.
  m.animate("rotation", {0, 3}, {0, 0, 0, 1, 0, 0, kHalf, kHalf}, "LINEAR");
  const PoseSequence s = read_built(m.b, 1).sequence;
  for (std::uint32_t k = 0; k <= 3; ++k) expect_pose(s, k, turned_about_z(30.0 * k));
}

TEST(GltfAnimation, RotationTakesTheShorterWay) {
  Moved m;
  // The same end as above with its sign changed: still 90 degrees, not 270 the other way.
  m.animate("rotation", {0, 3}, {0, 0, 0, 1, 0, 0, -kHalf, -kHalf}, "LINEAR");
  const PoseSequence s = read_built(m.b, 1).sequence;
  for (std::uint32_t k = 0; k <= 3; ++k) expect_pose(s, k, turned_about_z(30.0 * k));
}

TEST(GltfAnimation, NearlyEqualRotationsInterpolateWithoutLoss) {
  Moved m;
  const float tiny = 1e-4f;
  m.animate("rotation", {0, 2}, {0, 0, 0, 1, 0, 0, tiny, 1}, "LINEAR");
  const PoseSequence s = read_built(m.b, 1).sequence;
  EXPECT_NEAR(s.pose(1)[1].y, 1e-4, 1e-11);
}

TEST(GltfAnimation, CubicRotationIsNormalisedAfterTheSpline) {
  Moved m;
  // Tangents of zero: at the middle the spline is the mean of both, which is not of unit length;
  // normalised it is the half-way turn.
  m.animate("rotation", {0, 1},
            {0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, /**/ 0, 0, 0, 0, 0, 0, kHalf, kHalf, 0, 0, 0, 0},
            "CUBICSPLINE");
  const PoseSequence s = read_built(m.b, 4).sequence;
  expect_pose(s, 2, turned_about_z(45));
  // s = 1/4: weights 27/32 and 5/32.
  const double z = 5.0 / 32 * std::sqrt(0.5), w = 27.0 / 32 + z;
  expect_pose(s, 1, turned_about_z(2 * std::atan2(z, w) * 180 / std::numbers::pi));
}

TEST(GltfAnimation, ReadsNormalisedIntegerRotations) {
  Moved m;
  const int input = m.b.accessor<float>("SCALAR", {0, 1});
  const auto half = static_cast<std::int16_t>(std::lround(32767 * std::sqrt(0.5)));
  const int output = m.b.accessor<std::int16_t>("VEC4", {0, 0, 0, 32767, 0, 0, half, half},
                                                ", \"normalized\": true");
  m.b.animation(0, "rotation", input, output);
  const PoseSequence s = read_built(m.b, 1).sequence;
  expect_pose(s, 0, turned_about_z(0));
  expect_pose(s, 1, turned_about_z(90));  // equal parts stay equal once normalised
}

TEST(GltfAnimation, ScaleIsInterpolated) {
  Moved m;
  m.animate("scale", {0, 1}, {1, 1, 1, 3, 5, 1}, "LINEAR");
  expect_pose(read_built(m.b, 2).sequence, 1, {{0, 0, 0}, {2, 0, 0}, {0, 3, 0}});
}

TEST(GltfAnimation, AClipStartsAtItsFirstKeyAndItsTimesAtZero) {
  Moved m;
  m.animate("translation", {5, 6}, {1, 0, 0, 2, 0, 0}, "LINEAR");
  const PoseSequence s = read_built(m.b, 2).sequence;
  EXPECT_THAT(s.key_times, ElementsAre(0.0, 0.5, 1.0));
  expect_pose(s, 0, shifted(1, 0, 0));
  expect_pose(s, 1, shifted(1.5f, 0, 0));
}

TEST(GltfAnimation, TheEndIsAddedWhereTheGridMissesIt) {
  Moved m;
  m.animate("translation", {0, 1.25f}, {0, 0, 0, 5, 0, 0}, "LINEAR");
  const PoseSequence s = read_built(m.b, 2).sequence;
  EXPECT_THAT(s.key_times, Pointwise(DoubleNear(1e-12), {0.0, 0.5, 1.0, 1.25}));
  expect_pose(s, 3, shifted(5, 0, 0));
  // 4.2 s at 30 a second ends on the grid in spite of rounding: no key is added.
  Moved on_grid;
  on_grid.animate("translation", {0, 4.2f}, {0, 0, 0, 1, 0, 0}, "LINEAR");
  const PoseSequence t = read_built(on_grid.b, 30).sequence;
  EXPECT_EQ(t.key_count(), 127u);
  EXPECT_DOUBLE_EQ(t.key_times.back(), 126 / 30.0);
}

TEST(GltfAnimation, TracksHoldTheirEndsWhereOthersRunOn) {
  Moved m;
  const int early = m.b.accessor<float>("SCALAR", {1, 2});
  const int late = m.b.accessor<float>("SCALAR", {0, 4});
  const int shift = m.b.accessor<float>("VEC3", {1, 0, 0, 2, 0, 0});
  const int scale = m.b.accessor<float>("VEC3", {1, 1, 1, 5, 1, 1});
  m.b.add("animations",
          "{\"samplers\": [{\"input\": " + std::to_string(early) +
              ", \"output\": " + std::to_string(shift) + "}, {\"input\": " + std::to_string(late) +
              ", \"output\": " + std::to_string(scale) +
              "}], \"channels\": [{\"sampler\": 0, \"target\": {\"node\": 0, \"path\": "
              "\"translation\"}}, {\"sampler\": 1, \"target\": {\"node\": 0, \"path\": "
              "\"scale\"}}]}");
  const PoseSequence s = read_built(m.b, 1).sequence;
  ASSERT_EQ(s.key_count(), 5u);
  expect_pose(s, 0, {{1, 0, 0}, {2, 0, 0}, {1, 1, 0}});
  expect_pose(s, 4, {{2, 0, 0}, {7, 0, 0}, {2, 1, 0}});
}

TEST(GltfAnimation, AnAnimationWithoutLengthIsOneKey) {
  Moved m;
  m.animate("translation", {3}, {7, 0, 0}, "LINEAR");
  const PoseSequence s = read_built(m.b).sequence;
  EXPECT_THAT(s.key_times, ElementsAre(0.0));
  expect_pose(s, 0, shifted(7, 0, 0));
}

TEST(GltfAnimation, KeysAtTheSameTimeDoNotDivideByZero) {
  Moved m;
  m.animate("translation", {0, 1, 1, 2}, {0, 0, 0, 1, 0, 0, 5, 0, 0, 6, 0, 0}, "LINEAR");
  const PoseSequence s = read_built(m.b, 2).sequence;
  expect_pose(s, 1, shifted(0.5f, 0, 0));
  expect_pose(s, 2, shifted(5, 0, 0));
  expect_pose(s, 3, shifted(5.5f, 0, 0));
}

TEST(GltfAnimation, EachAnimationIsAClipAndOthersDoNotShowInIt) {
  Moved m;
  m.animate("translation", {0, 1}, {0, 0, 0, 4, 0, 0}, "LINEAR");
  m.animate("scale", {0, 1}, {1, 1, 1, 3, 1, 1}, "LINEAR");
  const PoseSequence s = read_built(m.b, 1).sequence;
  EXPECT_THAT(s.clips, ElementsAre(Clip{"clip 1", 0, 2}, Clip{"clip 2", 2, 2}));
  EXPECT_THAT(s.key_times, ElementsAre(0, 1, 0, 1));
  expect_pose(s, 1, {{4, 0, 0}, {5, 0, 0}, {4, 1, 0}});
  expect_pose(s, 3, {{0, 0, 0}, {3, 0, 0}, {0, 1, 0}});
}

TEST(GltfAnimation, ClipNamesAreUniqueAndChooseClips) {
  Moved m;
  const int input = m.b.accessor<float>("SCALAR", {0});
  const int output = m.b.accessor<float>("VEC3", {0, 0, 0});
  for (const char* name : {"Walk", "Walk 2", "Walk", "", "Walk"}) {
    const int a = m.b.animation(0, "translation", input, output);
    m.b.at("animations", a).insert(1, "\"name\": \"" + std::string(name) + "\", ");
  }
  const auto names = [](const ReadResult& r) {
    std::vector<std::string> all;
    for (const Clip& clip : r.sequence.clips) all.push_back(clip.name);
    return all;
  };
  EXPECT_THAT(names(read_built(m.b)), ElementsAre("Walk", "Walk 2", "Walk 3", "clip 4", "Walk 4"));
  EXPECT_THAT(names(read_built(m.b, 30, {"clip 4", "Walk 3"})), ElementsAre("Walk 3", "clip 4"));
  expect_refused(ErrorCode::kUsage, {"\"Run\"", "\"Walk\", \"Walk 2\", \"Walk 3\""}, [&] {
    read_built(m.b, 30, {"Walk", "Run"});
  });
}

TEST(GltfAnimation, MorphWeightsAreAnimatedPerTarget) {
  GltfBuilder b;
  const int positions = b.accessor<float>("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0});
  const int up = b.accessor<float>("VEC3", {0, 0, 2, 0, 0, 2, 0, 0, 2});
  const int away = b.accessor<float>("VEC3", {0, 0, 0, 4, 0, 0, 0, 0, 0});
  b.mesh("\"POSITION\": " + std::to_string(positions),
         ", \"targets\": [{\"POSITION\": " + std::to_string(up) +
             "}, {\"POSITION\": " + std::to_string(away) + "}]");
  b.add("nodes", "{\"mesh\": 0}");
  const int input = b.accessor<float>("SCALAR", {0, 2});
  b.animation(0, "weights", input, b.accessor<float>("SCALAR", {0, 1, 1, 0.5f}));
  const PoseSequence s = read_built(b, 1).sequence;
  expect_pose(s, 0, {{0, 0, 0}, {5, 0, 0}, {0, 1, 0}});
  expect_pose(s, 1, {{0, 0, 1}, {4, 0, 1}, {0, 1, 1}});
  expect_pose(s, 2, {{0, 0, 2}, {3, 0, 2}, {0, 1, 2}});
}

TEST(GltfAnimation, DoesNotDependOnTheNumberOfThreads) {
  Moved m;
  m.animate("rotation", {0, 1, 3}, {0, 0, 0, 1, 0.5f, 0.5f, 0.5f, 0.5f, 0, 0, kHalf, kHalf},
            "LINEAR");
  const auto read_with = [&](int threads) {
    const ThreadLimit limit(threads);
    return read_built(m.b, 100).sequence.positions;
  };
  EXPECT_EQ(read_with(1), read_with(4));
}

TEST(GltfAnimation, RefusesKeysThatDoNotFitTheirTimes) {
  Moved few, backwards;
  few.animate("translation", {0, 1, 2}, {0, 0, 0, 1, 0, 0}, "LINEAR");
  expect_refused(ErrorCode::kBadInput, {"animation 0", "2 values"}, [&] { read_built(few.b); });
  backwards.animate("translation", {0, 2, 1}, {0, 0, 0, 1, 0, 0, 2, 0, 0}, "LINEAR");
  expect_refused(ErrorCode::kBadInput, {"animation 0", "backwards"},
                 [&] { read_built(backwards.b); });
}

TEST(GltfAnimation, RefusesToMoveANodeThatHasAMatrix) {
  GltfBuilder b;
  b.add("nodes", "{\"mesh\": " + std::to_string(b.triangle_mesh()) +
                     ", \"matrix\": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]}");
  const int input = b.accessor<float>("SCALAR", {0});
  b.animation(0, "translation", input, b.accessor<float>("VEC3", {0, 0, 0}));
  expect_refused(ErrorCode::kBadInput, {"animation 0", "node 0", "matrix"}, [&] { read_built(b); });
}

TEST(GltfAnimation, RefusesRatesAndLengthsBeyondTheLimits) {
  Moved m;
  m.animate("translation", {0, 1e9f}, {0, 0, 0, 1, 0, 0}, "LINEAR");
  for (double fps : {0.0, -1.0, 10001.0, std::nan("")})
    expect_refused(ErrorCode::kUsage, {"--fps"}, [&] { read_built(m.b, fps); });
  expect_refused(ErrorCode::kOverLimit, {"test.gltf", "keys", "--fps", "--clips"},
                 [&] { read_built(m.b, 30); });
}

}  // namespace
}  // namespace mdk::test
