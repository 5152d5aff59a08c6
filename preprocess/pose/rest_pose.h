// Search for the rest pose (GFW06 §3.3): every pose is tried against every other, in closed form
// from the blocks of the clusters' Gram matrices.
//
// With C_t the centred second moments of a cluster's vertices in pose t and M those between poses r
// and t (r by t), the best affine map from t to r leaves tr C_r - tr(M C_t^-1 M^T), and the one
// from r to t leaves tr C_t - tr(M^T C_r^-1 M). GFW06 (3) sums the former, and so likes poses that
// are small or squashed: in them every residual is small, while the maps blow boxes up in the
// world. The latter asks the question that matters, how well r explains pose t, in pose t's own
// lengths: scaling or squashing r changes nothing or makes it worse.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "preprocess/decomposition.h"
#include "preprocess/pose/pose_table.h"

namespace mdk {

enum class RestPoseRule {
  kExplainsOthers,  ///< what r leaves of all t
  kIsExplained,     ///< what all t leave of r: GFW06 (3), with squared distances
};

/// The score of every row of the table: what is left by the rule over the poses of the rows
/// `targets`, summed over clusters and corners, table units squared.
/// Cost: 9 * rows * targets * vertices multiply-adds.
std::vector<double> score_rest_poses(const PoseTable& table, const ClusterMembers& members,
                                     std::span<const std::uint32_t> targets, RestPoseRule rule);

/// All rows are targets.
std::vector<double> score_rest_poses(const PoseTable& table, const ClusterMembers& members,
                                     RestPoseRule rule = RestPoseRule::kExplainsOthers);

/// The best rows, best first, at most `count`; ties go to the lower row.
std::vector<std::uint32_t> best_rest_rows(std::span<const double> scores, std::size_t count);

/// How rest poses are searched among all keys.
struct RestKeySearch {
  RestPoseRule rule = RestPoseRule::kExplainsOthers;
  std::size_t count = 1;           ///< how many of the best are returned, best first
  double max_multiply_adds = 4e9;  ///< above it fewer vertices, then fewer targets are looked at
};

/// Every key of the sequence is a candidate. Looks at all vertices and all poses, or at as many of
/// each as the budget allows: 24 vertices of a cluster and 32 poses at least. `unit`: see
/// pose_unit.
std::vector<std::uint32_t> best_rest_keys(const PoseSequence& sequence,
                                          const ClusterMembers& members, double unit,
                                          const RestKeySearch& search);

}  // namespace mdk
