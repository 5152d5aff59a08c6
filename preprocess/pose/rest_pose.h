// Exact search for the rest pose (GFW06 §3.3): every pose is tried against every other, in closed
// form from the blocks of the clusters' Gram matrices.
//
// With C_t the centred second moments of a cluster's vertices in pose t and M those between poses r
// and t (r by t), the best affine map from t to r leaves tr C_r - tr(M C_t^-1 M^T), and the one
// from r to t leaves tr C_t - tr(M^T C_r^-1 M). GFW06 (3) sums the former, and so likes poses that
// are small or squashed: in them every residual is small, while the maps blow boxes up in the
// world. The latter asks the question that matters, how well r explains pose t, in pose t's own
// lengths: scaling or squashing r changes nothing or makes it worse.
#pragma once

#include <cstdint>
#include <vector>

#include "preprocess/decomposition.h"
#include "preprocess/pose/pose_table.h"

namespace mdk {

enum class RestPoseRule {
  kExplainsOthers,  ///< what r leaves of all t
  kIsExplained,     ///< what all t leave of r: GFW06 (3), with squared distances
};

struct RestPoseScores {
  std::vector<std::uint32_t> rows;  ///< candidates, rising
  std::vector<double> residuals;  ///< beside `rows`: what is left by the rule over all candidates'
                                  ///< poses, summed over clusters and corners, table units squared
};

/// Scores of all candidates: all rows, or every n-th where all would take more multiply-adds.
/// Cost: 4.5 * candidates^2 * vertices multiply-adds.
RestPoseScores score_rest_poses(const PoseTable& table, const ClusterMembers& members,
                                RestPoseRule rule = RestPoseRule::kExplainsOthers,
                                double max_multiply_adds = 8e9);

/// The best candidates, best first, at most `count`; ties go to the lower row.
std::vector<std::uint32_t> best_rest_rows(const RestPoseScores& scores, std::size_t count);

}  // namespace mdk
