// Where each triangle would have the smallest fuzzy box: the question behind every move of box
// clustering, and most of its work. A box over a few rows is part of the box over all, so its area
// bounds the latter from below: clusters that are already too dear on a few rows, nearly all of
// them, are not looked at further.
#pragma once

#include <cstdint>
#include <vector>

#include "preprocess/box_clustering.h"

namespace mdk {

struct BoxAlternatives {
  std::vector<float> own_area;       ///< T: of the fuzzy box in its own cluster
  std::vector<float> other_area;     ///< T: in the best other cluster; infinite if there is none
  std::vector<std::uint32_t> other;  ///< T
};

/// A cluster number out of range in `clustering` makes the triangle's own area zero. Cost: at most
/// O(K * rows * vertices), vectorised, in parallel.
BoxAlternatives find_alternatives(const BoxProblem& problem, const BoxClustering& clustering);

/// Gives every triangle to the cluster in which its box is smallest.
std::vector<std::uint32_t> assign_to_smallest_boxes(const BoxProblem& problem,
                                                    std::vector<BoxCluster> clusters);

}  // namespace mdk
