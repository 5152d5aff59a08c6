// What reports give for a series of measurements: the median of times, and counters per ray.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/trace/frame_stats.h"

namespace mdk {

/// The mean of the two in the middle for an even number; 0 for none.
inline double median(std::vector<double> values) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

/// Work per ray, amortised over the rays of a tile as TraceCounters has it.
struct WorkPerRay {
  double node_visits = 0, leaf_triangles = 0, triangle_tests = 0, clusters = 0;
};

/// Zeros where there were no rays.
inline WorkPerRay work_per_ray(const TraceCounters& counters, std::uint64_t rays) {
  if (rays == 0) return {};
  const double n = static_cast<double>(rays);
  return {static_cast<double>(counters.node_visits) / n,
          static_cast<double>(counters.leaf_triangles) / n,
          static_cast<double>(counters.triangle_tests) / n,
          static_cast<double>(counters.clusters_entered) / n};
}

}  // namespace mdk
