// A few keys that stand for all: farthest-point sampling in pose space (Gonzalez 1985), which finds
// the extreme poses that uniform subsampling walks past.
#pragma once

#include <cstdint>
#include <vector>

#include "common/motion/pose_sequence.h"

namespace mdk {

struct KeySamplingOptions {
  std::uint32_t count = 64;         ///< keys wanted
  std::uint32_t max_points = 2048;  ///< vertices looked at, evenly spread over the list
};

/// `count` keys, rising; all if there are no more, fewer where the other poses repeat these. The
/// distance of two poses is the squared distance of their vertices, each pose centred. Starts with
/// the key farthest from the mean pose. Cost: O(keys * count * points).
std::vector<std::uint32_t> sample_keys(const PoseSequence& sequence,
                                       const KeySamplingOptions& options);

}  // namespace mdk
