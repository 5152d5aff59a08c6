// The point kernels against plain sums and boxes, and the same bits on every instruction set.
#include "preprocess/simd/point_kernels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <random>
#include <vector>

#include "common/base/isa.h"

namespace mdk {
namespace {

constexpr std::size_t kMultiples[] = {8, 16, 40, 104};
constexpr std::size_t kAnyCounts[] = {1, 7, 8, 15, 16, 17, 33, 100};

struct Points {
  std::vector<float> x, y, z, weights;

  Points(std::size_t n, std::uint32_t seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> place(-3, 3);
    for (std::size_t i = 0; i < n; ++i) {
      x.push_back(place(random));
      y.push_back(place(random));
      z.push_back(place(random));
      weights.push_back(static_cast<float>(i % 7));
    }
  }
  PointRow row() const { return {x.data(), y.data(), z.data()}; }
  double at(int axis, std::size_t i) const {
    return static_cast<double>((axis == 0 ? x : axis == 1 ? y : z)[i]);
  }
};

struct Boxes {
  std::vector<float> lo[3], hi[3];

  explicit Boxes(std::size_t n) {
    for (int axis = 0; axis < 3; ++axis) {
      lo[axis].assign(n, std::numeric_limits<float>::max());
      hi[axis].assign(n, std::numeric_limits<float>::lowest());
    }
  }
  BoxRow row() {
    return {{lo[0].data(), lo[1].data(), lo[2].data()}, {hi[0].data(), hi[1].data(), hi[2].data()}};
  }
  bool operator==(const Boxes&) const = default;
};

Affine3f some_map(float turn) {
  return {{{1, turn, 0.5f, -2}, {-turn, 0.25f, 1, 0.125f}, {0.3f, -0.7f, 2, turn}}};
}

/// Everything the kernels compute, to be compared bit by bit.
struct Results {
  std::vector<double> sums;
  std::vector<float> distances;
  std::vector<Boxes> boxes;
  bool operator==(const Results&) const = default;
};

Results run_all() {
  Results results;
  for (const std::size_t n : kMultiples) {
    const Points p(n, 1), q(n, 2);
    const SecondMoments m = second_moments(p.row(), p.weights.data(), n);
    results.sums.insert(results.sums.end(), m.first, m.first + 3);
    for (const auto& row : m.second) results.sums.insert(results.sums.end(), row, row + 3);
    double cross[3][3];
    cross_moments(p.row(), q.row(), p.weights.data(), n, cross);
    for (const auto& row : cross) results.sums.insert(results.sums.end(), row, row + 3);
    double pulls[4] = {};
    add_pulls({{0.3f, -0.2f, 0.1f, 0.5f}, q.x.data(), q.y.data()}, p.row(), p.weights.data(), n,
              pulls);
    results.sums.insert(results.sums.end(), pulls, pulls + 4);
  }
  for (const std::size_t n : kAnyCounts) {
    const Points p(n, 3), q(n, 4);
    std::vector<float> distances(n, 0.25f);
    add_squared_distances(some_map(0.4f), p.row(), q.row(), n, distances.data());
    results.distances.insert(results.distances.end(), distances.begin(), distances.end());
    const ScaledCoordinate u{{0.3f, -0.2f, 0.1f, 0.5f}, q.x.data(), q.y.data()};
    std::vector<float> powers(n, 0.5f);
    add_sixteenth_powers(u, p.row(), n, powers.data());
    results.distances.insert(results.distances.end(), powers.begin(), powers.end());
    Boxes boxes(n);
    for (const float turn : {0.0f, -0.6f, 1.7f})
      extend_boxes(some_map(turn), p.row(), n, boxes.row());
    results.boxes.push_back(boxes);
    std::vector<std::uint32_t> corners(3 * n);
    for (std::size_t i = 0; i < corners.size(); ++i)
      corners[i] = static_cast<std::uint32_t>(i * 7 % n);
    std::vector<float> areas(n);
    triangle_box_areas(corners.data(), n, boxes.row(), {0.5f, 2, 3}, areas.data());
    results.distances.insert(results.distances.end(), areas.begin(), areas.end());
  }
  return results;
}

class PointKernels : public testing::TestWithParam<std::string_view> {
 protected:
  void SetUp() override { limit_isa(GetParam()); }
  void TearDown() override { reset_isa(); }
};

TEST_P(PointKernels, SumMomentsAsAPlainLoopDoes) {
  for (const std::size_t n : kMultiples) {
    const Points p(n, 5), q(n, 6);
    const SecondMoments m = second_moments(p.row(), p.weights.data(), n);
    double cross[3][3];
    cross_moments(p.row(), q.row(), p.weights.data(), n, cross);
    for (int i = 0; i < 3; ++i) {
      double first = 0, second[3] = {}, mixed[3] = {};
      for (std::size_t k = 0; k < n; ++k) {
        const double w = static_cast<double>(p.weights[k]);
        first += w * p.at(i, k);
        for (int j = 0; j < 3; ++j) {
          second[j] += w * p.at(i, k) * p.at(j, k);
          mixed[j] += w * q.at(i, k) * p.at(j, k);
        }
      }
      EXPECT_NEAR(m.first[i], first, 1e-9);
      for (int j = 0; j < 3; ++j) {
        EXPECT_NEAR(m.second[i][j], second[j], 1e-9);
        EXPECT_NEAR(cross[i][j], mixed[j], 1e-9);
      }
    }
  }
}

TEST_P(PointKernels, BoxesHoldWhatTheMapsSendThere) {
  for (const std::size_t n : kAnyCounts) {
    const Points p(n, 7);
    Boxes boxes(n);
    for (const float turn : {0.0f, 0.9f}) extend_boxes(some_map(turn), p.row(), n, boxes.row());
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3f v{p.x[i], p.y[i], p.z[i]};
      const Vec3f a = some_map(0.0f).point(v), b = some_map(0.9f).point(v);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        EXPECT_EQ(boxes.lo[axis][i], std::min(a[axis], b[axis]));
        EXPECT_EQ(boxes.hi[axis][i], std::max(a[axis], b[axis]));
      }
    }
  }
}

TEST_P(PointKernels, BoxesOfManyRowsAreThoseOfEachRowAlone) {
  constexpr std::size_t kRows = 5, kStride = 40;
  const Points p(kRows * kStride, 12);
  std::vector<Affine3f> maps;
  for (std::size_t row = 0; row < kRows; ++row)
    maps.push_back(some_map(0.3f * static_cast<float>(row)));
  for (const std::size_t n : {1u, 7u, 16u, 33u, 40u})
    for (const std::size_t step : {1u, 2u}) {
      Boxes together(n), alone(n);
      extend_boxes({maps.data(), (kRows + step - 1) / step, step, p.row(), step * kStride}, n,
                   together.row());
      for (std::size_t row = 0; row < kRows; row += step) {
        const std::size_t at = row * kStride;
        extend_boxes(maps[row], {&p.x[at], &p.y[at], &p.z[at]}, n, alone.row());
      }
      EXPECT_TRUE(together == alone) << n << " points, every " << step;
    }
}

TEST_P(PointKernels, AreasAreThoseOfTheTrianglesBoxes) {
  for (const std::size_t n : kAnyCounts) {
    const Points p(n, 13);
    Boxes boxes(n);
    for (const float turn : {0.2f, 0.9f}) extend_boxes(some_map(turn), p.row(), n, boxes.row());
    std::mt19937 random(14);
    std::vector<std::uint32_t> corners;
    for (std::size_t i = 0; i < 3 * n; ++i)
      corners.push_back(static_cast<std::uint32_t>(random() % n));
    std::vector<float> areas(n);
    triangle_box_areas(corners.data(), n, boxes.row(), {0.5f, 2, 3}, areas.data());
    for (std::size_t t = 0; t < n; ++t) {
      double e[3];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        float lo = 1e9f, hi = -1e9f;
        for (std::size_t c = 0; c < 3; ++c) {
          lo = std::min(lo, boxes.lo[axis][corners[3 * t + c]]);
          hi = std::max(hi, boxes.hi[axis][corners[3 * t + c]]);
        }
        e[axis] = static_cast<double>(hi) - static_cast<double>(lo);
      }
      const double area = 2 * (0.5 * e[0] * e[1] + 2 * e[1] * e[2] + 3 * e[2] * e[0]);
      EXPECT_NEAR(areas[t], area, 1e-5 * area);
    }
  }
}

TEST_P(PointKernels, DistancesAreAddedToWhatIsThere) {
  for (const std::size_t n : kAnyCounts) {
    const Points p(n, 8), q(n, 9);
    std::vector<float> distances(n, 10.0f);
    add_squared_distances(some_map(0.5f), p.row(), q.row(), n, distances.data());
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3f d =
          some_map(0.5f).point({p.x[i], p.y[i], p.z[i]}) - Vec3f{q.x[i], q.y[i], q.z[i]};
      EXPECT_NEAR(distances[i], 10 + dot(d, d), 1e-4f * (10 + dot(d, d)));
    }
  }
}

TEST_P(PointKernels, PowersAndPullsAreThoseOfTheFormula) {
  constexpr std::size_t kCount = 40;
  const Points p(kCount, 10), q(kCount, 11);
  const std::vector<float> reciprocals(kCount, 0.8f);
  const ScaledCoordinate u{{0.3f, -0.2f, 0.1f, 0.5f}, q.x.data(), reciprocals.data()};
  std::vector<float> powers(kCount, 0.0f);
  add_sixteenth_powers(u, p.row(), kCount, powers.data());
  double pulls[4] = {}, expected[4] = {}, size = 0;
  add_pulls(u, p.row(), p.weights.data(), kCount, pulls);
  for (std::size_t i = 0; i < kCount; ++i) {
    const double value =
        0.8 * (0.3 * p.at(0, i) - 0.2 * p.at(1, i) + 0.1 * p.at(2, i) + 0.5 - q.at(0, i));
    EXPECT_NEAR(powers[i], std::pow(value, 16), 1e-4 * std::pow(value, 16) + 1e-9);
    const double pull = static_cast<double>(p.weights[i]) * std::pow(value, 15);
    for (int j = 0; j < 3; ++j) expected[j] += pull * p.at(j, i);
    expected[3] += pull;
    size += 3 * std::abs(pull);
  }
  for (int j = 0; j < 4; ++j) EXPECT_NEAR(pulls[j], expected[j], 1e-4 * size);
}

TEST_P(PointKernels, GiveTheBitsOfTheWeakestInstructionSet) {
  const Results here = run_all();
  limit_isa(available_isas().front());
  EXPECT_TRUE(here == run_all());
}

INSTANTIATE_TEST_SUITE_P(Isas, PointKernels, testing::ValuesIn(available_isas()),
                         [](const auto& tested) { return std::string(tested.param); });

}  // namespace
}  // namespace mdk
