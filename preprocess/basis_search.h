// A better basis for a finished cluster than its principal axes: a pattern search over rotations
// for the smallest summed area of the fuzzy boxes (GFW06 §3.4 stops at the axes).
#pragma once

#include <span>
#include <vector>

#include "preprocess/cluster_points.h"
#include "preprocess/cost.h"

namespace mdk {

/// Fuzzy boxes of a cluster under some maps: summed mean area in units of the model's.
/// `maps`: R, from centred row coordinates; `model_areas`: R. Cost: O(rows * vertices).
double fuzzy_area(const ClusterPoints& points, std::span<const Affine3d> maps,
                  std::span<const double> model_areas, const CostOptions& cost);

/// The maps, followed by the rotation that makes the boxes smallest; as they are where none was
/// found. Searched on up to 32 rows, judged on all. Cost: O(32 * vertices), some fifty times.
std::vector<Affine3d> turned_to_small_boxes(const ClusterPoints& points,
                                            std::span<const Affine3d> maps,
                                            std::span<const double> model_areas,
                                            const CostOptions& cost);

}  // namespace mdk
