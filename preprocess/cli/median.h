// The median: what reports give for a series of timings.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace mdk {

/// The mean of the two in the middle for an even number; 0 for none.
inline double median(std::vector<double> values) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

}  // namespace mdk
