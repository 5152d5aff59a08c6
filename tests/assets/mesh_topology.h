// Facts about how triangles hang together.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "common/math/vec3.h"

namespace mdk {

using TriangleIndices = std::array<std::uint32_t, 3>;

/// How many directed edges lack their one opposite, or occur twice; 0 for a closed, consistently
/// wound surface.
std::size_t unmatched_edges(std::span<const TriangleIndices> triangles);

/// Vertices that more than one fan of triangles shares; 0 for a manifold. Needs a closed surface.
std::size_t pinched_vertices(std::span<const TriangleIndices> triangles, std::size_t vertices);

/// V - E + F of a closed surface: 2 for one without handles.
long euler_characteristic(std::span<const TriangleIndices> triangles, std::size_t vertices);

/// Volume within a closed surface; negative if it is inside out.
double enclosed_volume(std::span<const TriangleIndices> triangles,
                       std::span<const Vec3d> positions);

}  // namespace mdk
