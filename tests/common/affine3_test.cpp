// The map between two keys: exact where parts turn, bounded where its inverse is singular.
#include "common/math/affine3.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <vector>

namespace mdk {
namespace {

constexpr double kPi = 3.14159265358979323846;

Affine3d turn_about_z(double angle, const Vec3d& shift) {
  Affine3d a;
  a.m[0][0] = a.m[1][1] = std::cos(angle);
  a.m[1][0] = std::sin(angle);
  a.m[0][1] = -a.m[1][0];
  for (int i = 0; i < 3; ++i) a.m[i][3] = shift[static_cast<std::size_t>(i)];
  return a;
}

Affine3d random_map(std::mt19937& random) {
  std::uniform_real_distribution<double> entry(-1, 1);
  Affine3d a;
  for (auto& row : a.m)
    for (double& m : row) m = entry(random);
  return a;
}

double largest_entry(const Affine3d& a) {
  double largest = 0;
  for (const auto& row : a.m)
    for (const double m : row) largest = std::max(largest, std::abs(m));
  return largest;
}

double largest_difference(const Affine3d& a, const Affine3d& b) {
  double largest = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 4; ++j) largest = std::max(largest, std::abs(a.m[i][j] - b.m[i][j]));
  return largest;
}

TEST(AffinePath, GivesTheStoredMapsAtItsEnds) {
  std::mt19937 random(1);
  for (int i = 0; i < 200; ++i) {
    const Affine3f a = to_float(random_map(random)), b = to_float(random_map(random));
    const AffinePath path(a, b);
    EXPECT_EQ(path.at(0), to_double(a));
    const double conditioning = largest_entry(to_double(b)) * largest_entry(inverse(to_double(b)));
    EXPECT_LT(largest_difference(path.at(1), to_double(b)),
              1e-13 * conditioning * conditioning * conditioning);
  }
}

TEST(AffinePath, KeepsTheVerticesOfATurningPartInPlace) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> coordinate(-2, 2), share(0, 1);
  // All in memory first, as a file has them: gcc 12 at -O3 else compares maps that it rounded to
  // float with others that it did not.
  std::vector<Affine3f> maps(1);
  for (int i = 0; i < 500; ++i)
    maps.push_back(to_float(turn_about_z(0.6 * coordinate(random), random_map(random).column(3)) *
                            to_double(maps.back())));
  for (std::size_t i = 0; i + 1 < maps.size(); ++i) {
    const Affine3f &a = maps[i], &b = maps[i + 1];
    const Vec3d local{coordinate(random), coordinate(random), coordinate(random)};
    const Vec3d v0 = inverse(to_double(a)).point(local), v1 = inverse(to_double(b)).point(local);
    const float s = static_cast<float>(share(random));
    const Vec3d seen = interpolate(a, b, s).point(v0 + (v1 - v0) * static_cast<double>(s));
    EXPECT_LT(length(seen - local), 1e-12) << "pair " << i << " at " << s;
  }
}

TEST(AffinePath, PassesAHalfTurnWithoutBlowingUp) {
  // The interpolated inverses are singular half-way.
  const Affine3f a = to_float(turn_about_z(0.3, {1, 2, 3}));
  const Affine3f b = to_float(turn_about_z(0.3 + kPi, {-1, 2, 0}));
  const AffinePath path(a, b);
  EXPECT_EQ(path.rational_pieces(), 0);
  for (int i = 0; i <= 1000; ++i)
    EXPECT_LT(largest_entry(path.at(static_cast<float>(i) / 1000)), 10);
}

TEST(AffinePath, CutsWideTurnsIntoPieces) {
  const Affine3f a = to_float(turn_about_z(0, {}));
  EXPECT_EQ(AffinePath(a, to_float(turn_about_z(kPi / 3, {}))).rational_pieces(), 1);
  EXPECT_GT(AffinePath(a, to_float(turn_about_z(0.8 * kPi, {}))).rational_pieces(), 1);
}

TEST(AffinePath, TakesMapsThatHaveNoInverse) {
  Affine3f flat;
  flat.m[2][2] = 0;
  for (const Affine3d& map : {interpolate(flat, {}, 0.5f), interpolate({}, flat, 0.5f)})
    EXPECT_EQ(map.m[2][2], 0.5);
  Affine3f broken;
  broken.m[0][1] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(AffinePath({}, broken).rational_pieces(), 0);
  EXPECT_EQ(AffinePath(broken, {}).rational_pieces(), 0);
}

TEST(DeterminantBounds, HoldTheDeterminantBetween) {
  std::mt19937 random(3);
  for (int i = 0; i < 500; ++i) {
    const Affine3d a = random_map(random), b = random_map(random);
    const DeterminantBounds bounds(a, b);
    for (int step = 0; step <= 16; ++step) {
      const double determinant = mix(a, b, step / 16.0).determinant();
      EXPECT_LE(bounds.min(), determinant + 1e-14);
      EXPECT_GE(bounds.max(), determinant - 1e-14);
    }
  }
}

}  // namespace
}  // namespace mdk
