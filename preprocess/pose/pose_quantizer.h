// From key positions to quantised poses: each vertex is kept by the first cluster that uses it, as
// the distance in that cluster's basis from where it rests.
#pragma once

#include <cstdint>
#include <span>

#include "common/motion/pose_sequence.h"
#include "common/motion/quantized_poses.h"
#include "preprocess/decomposition.h"

namespace mdk {

struct QuantizeOptions {
  double error = 1e-4;  ///< largest distance from what was read, relative to `unit`
  double unit = 1;      ///< world length
  std::uint32_t rest_key = 0;
};

/// Quantises the sequence, whose vertices must stand in the order in which `members` first uses
/// them, and replaces its positions by the decoded ones. `local_from_world`: F * K, key-major.
/// Throws Error (kUsage) where the error is so small that 16 bits or float cannot keep it. Runs in
/// parallel. Cost: O(keys * vertices).
QuantizedPoses quantize_poses(PoseSequence& sequence, const ClusterMembers& members,
                              std::span<const Affine3f> local_from_world,
                              const QuantizeOptions& options);

}  // namespace mdk
