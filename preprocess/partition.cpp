#include "preprocess/partition.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <utility>

namespace mdk {
namespace {

constexpr double kImpossible = std::numeric_limits<double>::infinity();

/// The cheapest ways to cover the first blocks with some number of runs: entry j is for j of them.
struct Covers {
  std::vector<double> cost;
  std::vector<std::uint32_t> last_run;  ///< first block of its last run

  explicit Covers(std::uint32_t blocks)
      : cost(blocks + std::size_t{1}, kImpossible), last_run(blocks + std::size_t{1}, 0) {}
};

/// Makes `covers` at `end` the cheapest cover that is one of `shorter` and one more run.
void add_last_run(const RunCosts& costs, const std::vector<double>& shorter, std::uint32_t end,
                  Covers& covers) {
  for (std::uint32_t first = end - std::min(end, costs.longest); first < end; ++first) {
    const double cost = shorter[first] + costs.of(first, end - 1);
    if (cost < covers.cost[end]) {
      covers.cost[end] = cost;
      covers.last_run[end] = first;
    }
  }
}

}  // namespace

std::vector<std::uint32_t> cheapest_runs(const RunCosts& costs, double price) {
  Covers covers(costs.blocks);
  covers.cost[0] = 0;
  for (std::uint32_t end = 1; end <= costs.blocks; ++end) {
    add_last_run(costs, covers.cost, end, covers);
    covers.cost[end] += price;
  }
  std::vector<std::uint32_t> runs;
  for (std::uint32_t end = costs.blocks; end > 0; end = runs.back())
    runs.push_back(covers.last_run[end]);
  std::reverse(runs.begin(), runs.end());
  return runs;
}

std::vector<std::uint32_t> cheapest_runs_of_count(const RunCosts& costs, std::uint32_t count) {
  std::vector<std::vector<std::uint32_t>> last_runs;  // per number of runs
  Covers shorter(costs.blocks);
  shorter.cost[0] = 0;
  for (std::uint32_t n = 1; n <= count; ++n) {
    Covers covers(costs.blocks);
    for (std::uint32_t end = n; end <= costs.blocks; ++end)
      add_last_run(costs, shorter.cost, end, covers);
    last_runs.push_back(covers.last_run);
    shorter = std::move(covers);
  }
  std::vector<std::uint32_t> runs;
  for (std::uint32_t n = count, end = costs.blocks; n > 0; --n) {
    end = last_runs[n - 1][end];
    runs.push_back(end);
  }
  std::reverse(runs.begin(), runs.end());
  return runs;
}

}  // namespace mdk
