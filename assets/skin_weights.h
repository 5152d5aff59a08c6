// How much each joint of the hand moves each vertex of its skin.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "assets/hand_shape.h"
#include "assets/hand_skeleton.h"
#include "assets/surface_mesher.h"

namespace mdk {

/// Up to four joints of one vertex; unused places have weight 0. The weights sum to 65535.
struct SkinInfluence {
  std::array<std::uint8_t, 4> joints{};
  std::array<std::uint16_t, 4> weights{};
};

/// Weights for the vertices of `mesh`, the surface of `shape`. A joint's share begins at the plane
/// through it, spreads along the surface, and never reaches another finger beyond the web.
std::vector<SkinInfluence> skin_weights(const TriangleMesh& mesh, const HandSkeleton& skeleton,
                                        const HandShape& shape);

}  // namespace mdk
