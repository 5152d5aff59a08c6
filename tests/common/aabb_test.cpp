// Boxes on the grid of another box: they hold what they are made of, tightly and in order.
#include "common/math/aabb.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <random>
#include <utility>
#include <vector>

namespace mdk {
namespace {

constexpr std::uint32_t kSeed = 20261122;

/// Intervals as boxes have them: usual ones, flat, a few float steps wide, lopsided, at the ends of
/// what a float holds.
std::vector<std::pair<float, float>> frame_sides() {
  constexpr float kMax = std::numeric_limits<float>::max();
  constexpr float kMin = std::numeric_limits<float>::denorm_min();
  return {{-1, 1},           {0, 0},           {7, 7},           {1, 1 + 0x1p-23f},
          {1, 1 + 0x1p-18f}, {-1e10f, 1e-10f}, {-1e-30f, 1e10f}, {1e6f, 1e6f + 3},
          {-2e-6f, 1e-6f},   {0, kMin},        {-kMax, kMax},    {0, kMax},
          {-kMin, 40 * kMin}};
}

float between(float lo, float hi, std::mt19937& random) {
  std::uniform_real_distribution<double> share(0, 1);
  const double s = share(random);
  return static_cast<float>(static_cast<double>(lo) * (1 - s) + static_cast<double>(hi) * s);
}

TEST(Rounding, IsToTheNeighbouringFloat) {
  constexpr float kInf = std::numeric_limits<float>::infinity();
  constexpr float kMax = std::numeric_limits<float>::max();
  constexpr float kMin = std::numeric_limits<float>::denorm_min();
  for (const float f : {0.0f, -0.0f, kMin, -kMin, 0x1p-126f, -0x1p-126f, 1.0f, -1.0f, 0x1.fffffep3f,
                        kMax, -kMax, kInf})
    EXPECT_EQ(next_below(f), std::nextafter(f, -kInf)) << f;
  EXPECT_EQ(round_down(1 + 1e-12), 1);
  EXPECT_EQ(round_up(1 + 1e-12), 1 + 0x1p-23f);
  EXPECT_EQ(round_down(-1e-60), -kMin);
  EXPECT_EQ(round_up(1e-60), kMin);
  EXPECT_EQ(round_up(0), 0);
  EXPECT_EQ(round_down(1e300), kMax);
  EXPECT_EQ(round_up(-1e300), -kMax);
}

TEST(QuantizedBox, HoldsTheBoxItIsMadeOfAndStaysInItsFrame) {
  std::printf("seed %u\n", kSeed);
  std::mt19937 random(kSeed);
  for (const auto& [lo, hi] : frame_sides()) {
    const Aabb frame{{lo, lo, lo}, {hi, hi, hi}};
    for (int i = 0; i < 3000; ++i) {
      Aabb box;
      for (int corner = 0; corner < 2; ++corner)
        box.extend(
            Vec3f{between(lo, hi, random), between(lo, hi, random), between(lo, hi, random)});
      const Aabb held = dequantize(quantize_outward(box, frame), frame);
      ASSERT_TRUE(held.contains(box)) << lo << " to " << hi << ", try " << i;
      ASSERT_TRUE(frame.contains(held)) << lo << " to " << hi << ", try " << i;
    }
  }
}

TEST(QuantizedBox, TouchesItsFrameExactlyWhereTheBoxDoes) {
  for (const auto& [lo, hi] : frame_sides()) {
    const Aabb frame{{lo, lo, lo}, {hi, hi, hi}};
    EXPECT_EQ(dequantize(quantize_outward(frame, frame), frame), frame) << lo << " to " << hi;
  }
}

TEST(QuantizedBox, EachSideMovesByLessThanTwoPlaces) {
  std::printf("seed %u\n", kSeed);
  std::mt19937 random(kSeed);
  const Aabb frame{{-3, 0, 10}, {5, 1, 10.5f}};
  for (int i = 0; i < 3000; ++i) {
    Aabb box;
    for (int corner = 0; corner < 2; ++corner)
      box.extend(Vec3f{between(-3, 5, random), between(0, 1, random), between(10, 10.5f, random)});
    const Aabb held = dequantize(quantize_outward(box, frame), frame);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const float two_places = 2 * frame.extent()[axis] / 65535;
      EXPECT_LT(box.lo[axis] - held.lo[axis], two_places);
      EXPECT_LT(held.hi[axis] - box.hi[axis], two_places);
    }
  }
}

TEST(QuantizedBox, PlacesLieInOrderInAnyFrame) {
  for (const auto& [lo, hi] : frame_sides()) {
    float before = grid_coordinate(lo, hi, 0);
    EXPECT_EQ(before, lo);
    for (std::uint32_t q = 1; q <= 65535; ++q) {
      const float here = grid_coordinate(lo, hi, static_cast<std::uint16_t>(q));
      ASSERT_LE(before, here) << lo << " to " << hi << ", place " << q;
      before = here;
    }
    EXPECT_EQ(before, hi);
  }
}

TEST(QuantizedBox, OfANumberThatIsNoneIsSomeBoxInTheFrame) {
  const float nan = std::nanf("");
  const Aabb frame{{0, 0, 0}, {1, 1, 1}};
  const QuantizedBox box = quantize_outward({{nan, 0, 0}, {nan, 1, 1}}, frame);
  EXPECT_TRUE(frame.contains(dequantize(box, frame)));
}

}  // namespace
}  // namespace mdk
