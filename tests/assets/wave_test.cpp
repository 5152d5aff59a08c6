#include "assets/wave.h"

#include <gtest/gtest.h>

#include <numbers>

namespace mdk {
namespace {

TEST(Wave, IsTheSineOfAsManyTurns) {
  for (int i = -4000; i <= 4000; ++i) {
    const double turns = i * 0.00107;
    EXPECT_NEAR(sine(turns), std::sin(2 * std::numbers::pi * turns), 1e-11) << turns;
    EXPECT_NEAR(cosine(turns), std::cos(2 * std::numbers::pi * turns), 1e-11) << turns;
  }
}

TEST(Wave, IsExactAtQuarters) {
  EXPECT_EQ(sine(0), 0);
  EXPECT_EQ(sine(3), 0);
  EXPECT_EQ(sine(0.5), 0);
  EXPECT_EQ(sine(0.25), cosine(0));
  EXPECT_EQ(sine(-0.75), sine(0.25));
}

}  // namespace
}  // namespace mdk
