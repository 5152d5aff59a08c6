// How much each joint of BEN moves each vertex of his skin.
#pragma once

#include "assets/ben_rig.h"
#include "assets/surface_mesher.h"

namespace mdk {

struct BenWeights {
  std::vector<std::array<std::uint8_t, 4>> joints;
  std::vector<std::array<std::uint16_t, 4>> weights;  ///< they sum to 65535
};

/// Every vertex belongs to the bone it lies on; then shares spread along the surface, as heat
/// would.
BenWeights ben_weights(const TriangleMesh& mesh, const BenRig& rig);

}  // namespace mdk
