// Residuals: how far the motion of each triangle is from what its cluster's map explains.
#pragma once

#include <span>

#include "common/motion/posed_mesh.h"

namespace mdk {

/// Per triangle, the largest residual of its corners in the present pose, relative to the rest
/// pose's diagonal (GFW06 §3.1): the distance, in the cluster's basis, of the corner from where it
/// is in the rest pose. `out` has one per triangle. Decodes the rest pose. Runs in parallel. Cost:
/// O(vertices + triangles).
void triangle_residuals(const PosedMesh& mesh, std::span<float> out);

}  // namespace mdk
