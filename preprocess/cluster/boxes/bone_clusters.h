// Bones as clusters (GFSS06; Lo09 §4.3): a cluster's basis is a bone's, A_c(t) = bone⁻¹(t), and a
// triangle goes to the bone in whose basis its fuzzy box is smallest: all bones that move one of
// its corners are tried. Parts that move rigidly are bones, too (common/motion/rig.h).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/motion/pose_sequence.h"
#include "preprocess/decomposition.h"
#include "preprocess/pose/pose_space.h"

namespace mdk {

struct BoneClusters : Assignment {
  std::vector<std::uint32_t> bones;  ///< K, rising: the bone of each cluster; each has triangles
};

/// Judges boxes over `keys` (rising) and, where there is one, over a pose space. The sequence has a
/// rig. Cost: O(keys * bone weights).
BoneClusters assign_to_bones(const PoseSequence& sequence, std::span<const std::uint32_t> keys,
                             const PoseSpace* space);

}  // namespace mdk
