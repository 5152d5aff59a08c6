// What the counters come to per ray, as reports give it.
#pragma once

#include <cstdint>

#include "common/trace/frame_stats.h"

namespace mdk {

/// Work per ray, amortised over the rays of a tile as TraceCounters has it.
struct WorkPerRay {
  double node_visits = 0, triangle_tests = 0, clusters = 0;
};

/// Zeros where there were no rays.
inline WorkPerRay work_per_ray(const TraceCounters& counters, std::uint64_t rays) {
  if (rays == 0) return {};
  const double n = static_cast<double>(rays);
  return {static_cast<double>(counters.node_visits) / n,
          static_cast<double>(counters.triangle_tests) / n,
          static_cast<double>(counters.clusters_entered) / n};
}

}  // namespace mdk
