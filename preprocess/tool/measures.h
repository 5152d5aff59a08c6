// What reports give for a series of measurements: the median of times, and counters per ray.
#pragma once

#include <algorithm>
#include <cmath>
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

/// Spearman's rank correlation of two lists of one length, 1 to -1; equal values share the mean of
/// their ranks. 0 where one of them is constant.
inline double rank_correlation(const std::vector<double>& a, const std::vector<double>& b) {
  const auto ranks = [](const std::vector<double>& values) {
    std::vector<double> rank;
    for (const double v : values) {
      double below = 0, same = 0;
      for (const double other : values) {
        below += other < v;
        same += other == v;
      }
      rank.push_back(below + (same - 1) / 2 - (static_cast<double>(values.size()) - 1) / 2);
    }
    return rank;
  };
  const std::vector<double> x = ranks(a), y = ranks(b);
  double xy = 0, xx = 0, yy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    xy += x[i] * y[i];
    xx += x[i] * x[i];
    yy += y[i] * y[i];
  }
  return xx > 0 && yy > 0 ? xy / std::sqrt(xx * yy) : 0;
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
