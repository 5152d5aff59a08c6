// The maps of the finished decomposition: every cluster at every key, as the model stores them.
#pragma once

#include <cstdint>
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
};

/// Fits all keys to the rest pose, block by block, so that memory stays small beside the sequence.
/// `local_from_rest`: K, see LocalFrames. `unit`: see pose_unit. Cost: O(keys * vertices).
KeyMaps fit_key_maps(const PoseSequence& sequence, const ClusterMembers& members,
                     std::uint32_t rest_key, std::span<const Affine3d> local_from_rest,
                     double unit);

/// Identity maps for every key: local boxes are world boxes.
KeyMaps identity_key_maps(const PoseSequence& sequence, const ClusterMembers& members,
                          std::uint32_t rest_key);

}  // namespace mdk
