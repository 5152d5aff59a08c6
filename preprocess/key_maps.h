// The maps of the finished decomposition: every cluster at every key, as the model stores them.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "common/math/affine3.h"
#include "common/motion/pose_sequence.h"
#include "preprocess/cluster_members.h"

namespace mdk {

/// Distances |A v - r| over all keys and triangle corners, world lengths.
struct ResidualStats {
  double rms = 0, max = 0;
};

struct KeyMaps {
  std::vector<Affine3f> local_from_world;  ///< F * K, key-major
  ResidualStats residual;
  double refine_gain = 0;  ///< share by which refinement lowered the summed area of the fuzzy boxes
};

/// What maps are fitted for.
struct KeyMapRequest {
  std::uint32_t rest_key = 0;
  double unit = 1;  ///< see pose_unit
  bool refine = true;
};

/// Maps towards small boxes, cluster by cluster at all keys: least squares, the rotation that suits
/// the boxes best, then refinement, kept where it makes the boxes of all times smaller. `report`
/// hears the share of the work done. Cost: O(keys * vertices).
KeyMaps fit_small_boxes(const PoseSequence& sequence, const ClusterMembers& members,
                        const KeyMapRequest& request, const std::function<void(double)>& report);

/// The paper's maps: each key fitted to the rest pose by least squares, block by block, so that
/// memory stays small beside the sequence. `local_from_rest`: K, see LocalFrames.
/// Cost: O(keys * vertices).
KeyMaps fit_key_maps(const PoseSequence& sequence, const ClusterMembers& members,
                     const KeyMapRequest& request, std::span<const Affine3d> local_from_rest);

/// Identity maps for every key: local boxes are world boxes.
KeyMaps identity_key_maps(const PoseSequence& sequence, const ClusterMembers& members,
                          std::uint32_t rest_key);

/// Residuals of any maps: local positions taken back to the world by the cluster's map at the rest
/// key, and compared with the rest pose. Cost: O(keys * vertices).
ResidualStats residual_stats(const PoseSequence& sequence, const ClusterMembers& members,
                             std::span<const Affine3f> local_from_world, std::uint32_t rest_key);

}  // namespace mdk
