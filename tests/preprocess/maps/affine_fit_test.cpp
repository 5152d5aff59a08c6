#include "preprocess/maps/affine_fit.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "tests/preprocess/moving_meshes.h"

namespace mdk {
namespace {

FitMoments moments_of(const std::vector<Vec3d>& from, const std::vector<Vec3d>& to) {
  MomentSum sum;
  for (std::size_t i = 0; i < from.size(); ++i) sum.add(from[i], to[i], 1);
  return sum.moments();
}

Eigen::Vector3d singular_values(const Affine3d& a) {
  Eigen::Matrix3d m;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) m(i, j) = a.m[i][j];
  return Eigen::JacobiSVD<Eigen::Matrix3d>(m).singularValues();
}

double summed_distance(const Affine3d& map, const std::vector<Vec3d>& from,
                       const std::vector<Vec3d>& to) {
  double sum = 0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const Vec3d d = map.point(from[i]) - to[i];
    sum += dot(d, d);
  }
  return sum;
}

void expect_usable(const Affine3d& map, const FitOptions& options) {
  for (const auto& row : map.m)
    for (const double m : row) ASSERT_TRUE(std::isfinite(m));
  const Eigen::Vector3d s = singular_values(map);
  EXPECT_LE(s(0), options.max_condition * s(2) * (1 + 1e-9));
  EXPECT_LE(s(0), options.max_scale * (1 + 1e-9));
  EXPECT_GE(s(2), (1 - 1e-9) / options.max_scale);
}

std::vector<Vec3d> random_points(std::mt19937& random, int count, const Vec3d& size) {
  std::vector<Vec3d> points;
  for (int i = 0; i < count; ++i) {
    const Vec3d p = random_point(random, 1);
    points.push_back({p.x * size.x, p.y * size.y, p.z * size.z});
  }
  return points;
}

std::vector<Vec3d> mapped(const Affine3d& map, const std::vector<Vec3d>& points) {
  std::vector<Vec3d> result;
  for (const Vec3d& p : points) result.push_back(map.point(p));
  return result;
}

TEST(AffineFit, RecoversAffineMapsExactlyWhereThePointsObeyOne) {
  std::mt19937 random(1);
  for (int round = 0; round < 200; ++round) {
    const Affine3d truth = random_affine(random);
    const std::vector<Vec3d> from = random_points(random, 12, {1, 1, 1});
    const AffineFit fit = fit_affine(moments_of(from, mapped(truth, from)));
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 4; ++j)
        EXPECT_NEAR(fit.target_from_source.m[i][j], truth.m[i][j], 1e-6) << "round " << round;
    EXPECT_LT(fit.residual, 1e-10);
  }
}

TEST(AffineFit, LosesNoDigitsFarFromTheOrigin) {
  std::mt19937 random(2);
  const Affine3d turn = rigid_motion({1, 2, 3}, 0.7, {1e6, -2e6, 5e5});
  std::vector<Vec3d> from = random_points(random, 20, {0.01, 0.01, 0.01});
  for (Vec3d& p : from) p += {3e6, 3e6, 3e6};
  const std::vector<Vec3d> to = mapped(turn, from);
  const AffineFit fit = fit_affine(moments_of(from, to));
  EXPECT_LT(std::sqrt(summed_distance(fit.target_from_source, from, to) / 20), 1e-7);
}

TEST(AffineFit, ResidualIsTheSummedSquaredDistanceItClaims) {
  std::mt19937 random(3);
  for (int round = 0; round < 50; ++round) {
    const std::vector<Vec3d> from = random_points(random, 15, {1, 0.5, 0.1});
    const std::vector<Vec3d> to = random_points(random, 15, {1, 1, 1});
    const AffineFit fit = fit_affine(moments_of(from, to));
    EXPECT_NEAR(fit.residual, summed_distance(fit.target_from_source, from, to), 1e-9);
  }
}

TEST(AffineFit, NoOtherMapLeavesLessWithoutARidge) {
  std::mt19937 random(4);
  const std::vector<Vec3d> from = random_points(random, 15, {1, 1, 1});
  const std::vector<Vec3d> to = random_points(random, 15, {1, 1, 1});
  FitOptions options;
  options.ridge = 0;
  const AffineFit fit = fit_affine(moments_of(from, to), options);
  std::normal_distribution<double> step(0, 0.01);
  for (int round = 0; round < 200; ++round) {
    Affine3d other = fit.target_from_source;
    for (auto& row : other.m)
      for (double& m : row) m += step(random);
    EXPECT_GE(summed_distance(other, from, to), fit.residual - 1e-9);
  }
}

TEST(AffineFit, WeightsCountLikeRepeatedPoints) {
  std::mt19937 random(5);
  const std::vector<Vec3d> from = random_points(random, 8, {1, 1, 1});
  const std::vector<Vec3d> to = random_points(random, 8, {1, 1, 1});
  MomentSum weighted, repeated;
  for (std::size_t i = 0; i < from.size(); ++i) {
    weighted.add(from[i], to[i], static_cast<double>(i + 1));
    for (std::size_t n = 0; n <= i; ++n) repeated.add(from[i], to[i], 1);
  }
  const Affine3d a = fit_affine(weighted.moments()).target_from_source;
  const Affine3d b = fit_affine(repeated.moments()).target_from_source;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 4; ++j) EXPECT_NEAR(a.m[i][j], b.m[i][j], 1e-9);
}

/// A turned flat, thin or tiny set of points: the map must be the turn itself, the open directions
/// included, because a proper rotation settles them.
struct ThinCase {
  const char* name;
  Vec3d size;
  int points;
};

class ThinClusters : public testing::TestWithParam<ThinCase> {};

TEST_P(ThinClusters, GetAProperRotationAndAUsableMap) {
  std::mt19937 random(6);
  const FitOptions options;
  for (int round = 0; round < 50; ++round) {
    const Affine3d turn =
        rigid_motion(random_point(random, 1), 2.5 * round / 50.0, random_point(random, 5));
    const std::vector<Vec3d> from = random_points(random, GetParam().points, GetParam().size);
    const std::vector<Vec3d> to = mapped(turn, from);
    const AffineFit fit = fit_affine(moments_of(from, to), options);
    expect_usable(fit.target_from_source, options);
    EXPECT_GT(fit.target_from_source.determinant(), 0) << "mirrored";
    EXPECT_LT(summed_distance(fit.target_from_source, from, to), 1e-9);
    const Eigen::Vector3d s = singular_values(fit.target_from_source);
    EXPECT_NEAR(s(0), 1, 1e-4);
    EXPECT_NEAR(s(2), 1, 1e-4);
  }
}

INSTANTIATE_TEST_SUITE_P(
    AffineFit, ThinClusters,
    testing::Values(ThinCase{"FlatSheet", {1, 1, 0}, 20}, ThinCase{"Line", {1, 0, 0}, 20},
                    ThinCase{"OneTriangle", {1, 1, 1}, 3}, ThinCase{"TwoPoints", {1, 1, 1}, 2},
                    ThinCase{"OnePoint", {1, 1, 1}, 1}, ThinCase{"CoincidentPoints", {0, 0, 0}, 9}),
    [](const auto& tested) { return tested.param.name; });

TEST(AffineFit, AnyMixtureOfCollapsedPosesGivesABoundedMap) {
  std::mt19937 random(7);
  const FitOptions options;
  const Vec3d shapes[] = {{1, 1, 1},    {1, 1, 0},    {1, 0, 0},      {0, 0, 0},
                          {1e-7, 1, 1}, {1e-7, 0, 1}, {1e6, 1, 1e-6}, {1e-9, 1e-9, 1e-9}};
  for (const Vec3d& source : shapes)
    for (const Vec3d& target : shapes)
      for (const int count : {1, 2, 3, 4, 20})
        expect_usable(fit_affine(moments_of(random_points(random, count, source),
                                            random_points(random, count, target)),
                                 options)
                          .target_from_source,
                      options);
}

TEST(AffineFit, NoiseAcrossAThinSheetDoesNotStretchItsNormal) {
  // A sheet 1 wide whose heights are noise: plain least squares maps the normal by any factor.
  std::mt19937 random(8);
  FitOptions plain;
  plain.ridge = 0;
  double largest_without = 0, largest_with = 0;
  for (int round = 0; round < 20; ++round) {
    const std::vector<Vec3d> from = random_points(random, 20, {1, 1, 1e-4});
    std::vector<Vec3d> to = from;
    for (Vec3d& p : to) p.z = random_point(random, 1e-2).z;
    const auto stretch = [&](const FitOptions& options) {
      return singular_values(fit_affine(moments_of(from, to), options).target_from_source)(0);
    };
    largest_without = std::max(largest_without, stretch(plain));
    largest_with = std::max(largest_with, stretch({}));
  }
  EXPECT_GT(largest_without, 10) << "the case is too easy to tell";
  EXPECT_LT(largest_with, 1.2);
}

TEST(AffineFit, ANearlyFlatClusterIsNeverTurnedInsideOutWhereThatIsForbidden) {
  // Across the sheet there is noise alone: least squares mirrors it half of the time.
  std::mt19937 random(320);
  const FitOptions free{.noise = 1e-7};
  const FitOptions kept{.noise = 1e-7, .keep_orientation = true};
  int mirrored = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const std::vector<Vec3d> from = random_points(random, 30, {1, 1, 1e-3});
    std::vector<Vec3d> to = from;
    for (Vec3d& p : to) p.z = 1e-3 * random_point(random, 1).z;
    const FitMoments moments = moments_of(from, to);
    mirrored += fit_affine(moments, free).target_from_source.determinant() < 0;
    EXPECT_GT(fit_affine(moments, kept).target_from_source.determinant(), 0) << "trial " << trial;
  }
  EXPECT_GT(mirrored, 20);
}

TEST(AffineFit, KeepingTheOrientationChangesNothingWhereAffineMotionIsExact) {
  std::mt19937 random(321);
  for (int trial = 0; trial < 50; ++trial) {
    const Affine3d map = random_affine(random);
    if (!(map.determinant() > 0)) continue;
    const std::vector<Vec3d> from = random_points(random, 40, {1, 1, 0.5});
    const FitMoments moments = moments_of(from, mapped(map, from));
    const AffineFit fit = fit_affine(moments, {.ridge = 2, .keep_orientation = true});
    EXPECT_LT(summed_distance(fit.target_from_source, from, mapped(map, from)), 1e-12);
  }
}

}  // namespace
}  // namespace mdk
