// A binary hierarchy for boxes that move: built for the surface area heuristic summed over several
// poses (T-SAH, Bittner and Meister 2015), so that refitting it serves all of them well.
#pragma once

#include <cstdint>
#include <span>

#include "common/math/aabb.h"
#include "common/structures/bvh.h"

namespace mdk {

/// `boxes`: those of N items in each of `poses` poses, pose after pose; finite, none empty. Each
/// pose counts alike: areas are relative to its root's. Splits are sought among the centroids of
/// several poses. The nodes hold their boxes in the first pose. Uses config.bins (at most 64) and
/// its costs. Cost: O(poses * N log N). The result depends on the input alone.
Bvh build_temporal_bvh(std::span<const Aabb> boxes, std::uint32_t poses,
                       const BvhBuildConfig& config);

}  // namespace mdk
