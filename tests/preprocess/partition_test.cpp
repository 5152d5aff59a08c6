#include "preprocess/partition.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstdio>
#include <limits>
#include <optional>
#include <random>

namespace mdk {
namespace {

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
double least_cost(const RunCosts& costs, double price, std::optional<std::uint32_t> count) {
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
                  least_cost(costs, price, std::nullopt), 1e-12);
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
      EXPECT_NEAR(cost_of(costs, cuts_of(runs), 0).value_or(kInf), least_cost(costs, 0, count),
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
