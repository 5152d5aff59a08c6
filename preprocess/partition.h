// Cutting a row of blocks into runs at the least summed cost, by dynamic programming: the cheapest
// way to cover the first j blocks ends with some run [i, j), before which stands the cheapest way
// to cover i blocks.
#pragma once

#include <cstdint>
#include <vector>

namespace mdk {

/// What each run of up to `longest` consecutive blocks costs.
struct RunCosts {
  std::uint32_t blocks = 0, longest = 0;
  std::vector<double> values;  ///< blocks * longest: run of n + 1 blocks from b at b * longest + n

  RunCosts(std::uint32_t block_count, std::uint32_t longest_run)
      : blocks(block_count),
        longest(longest_run),
        values(static_cast<std::size_t>(block_count) * longest_run) {}
  double& of(std::uint32_t first, std::uint32_t last) {
    return values[static_cast<std::size_t>(first) * longest + (last - first)];
  }
  double of(std::uint32_t first, std::uint32_t last) const {
    return values[static_cast<std::size_t>(first) * longest + (last - first)];
  }
};

/// First block of each run of the cheapest partition, where each run costs `price` on top; of
/// equally cheap ones any, but always the same. `costs.longest` is at least 1. Cost: O(blocks *
/// longest).
std::vector<std::uint32_t> cheapest_runs(const RunCosts& costs, double price);

/// The cheapest partition into exactly `count` runs; ceil(blocks / longest) <= count <= blocks.
/// Cost: O(count * blocks * longest).
std::vector<std::uint32_t> cheapest_runs_of_count(const RunCosts& costs, std::uint32_t count);

}  // namespace mdk
