// How many clusters: from one, all clusters that pay are cut at once, relaxed, and those that no
// longer pay are dissolved, until the cost stays.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "preprocess/box_clustering.h"

namespace mdk {

struct BoxGrowthOptions {
  std::uint32_t clusters = 0;       ///< exactly so many; 0: as many as pay
  std::uint32_t limit = 80;         ///< most clusters without an exact count
  double least_cut_gain = -0.1;     ///< a cut may cost a little at first: relaxation pays it back
  int leaps = 3;                    ///< doublings that may raise the cost before growth gives up
  double least_stage_gain = 0.005;  ///< share of the cost that a stage must save to go on
  LloydOptions relax{.min_gain = 0.005, .max_rounds = 3};
  int polish_rounds = 0;  ///< of careful cuts at the end, where growth ended because of the cost
};

struct BoxGrowthStep {
  std::uint32_t clusters = 0;
  double residual_rms = 0;  ///< per corner and row, table units
  double cost = 0;
  double fuzzy_area = 0;  ///< the part of the cost that is fuzzy_area (preprocess/cost.h)
};

struct BoxGrowth {
  BoxClustering clustering;
  std::vector<BoxGrowthStep> steps;
  std::string stop_reason;  ///< "cost", "count" or "limit"
};

/// `start`: a cluster per triangle, all in use. `on_step` is called with the start and after each
/// stage. `options.clusters` must not exceed the number of triangles.
BoxGrowth grow_boxes(const BoxProblem& problem, std::vector<std::uint32_t> start,
                     const BoxGrowthOptions& options,
                     const std::function<void(const BoxGrowthStep&)>& on_step);

}  // namespace mdk
