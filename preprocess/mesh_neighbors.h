// Which triangles meet at a vertex, and patches grown from a triangle.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/motion/pose_sequence.h"

namespace mdk {

/// Compressed lists: the triangles that use each vertex, in rising order.
struct VertexTriangles {
  std::vector<std::uint32_t> begin;  ///< vertices + 1
  std::vector<std::uint32_t> triangles;

  std::span<const std::uint32_t> of(std::uint32_t vertex) const {
    return std::span(triangles).subspan(begin[vertex], begin[vertex + 1] - begin[vertex]);
  }
};

/// Cost: O(triangles + vertices).
VertexTriangles make_vertex_triangles(std::span<const Triangle> triangles,
                                      std::uint32_t vertex_count);

/// `seed` and its neighbours (triangles that share a vertex), ring by ring, until the patch has
/// `min_vertices` or its part of the mesh ends.
std::vector<std::uint32_t> grow_patch(std::span<const Triangle> triangles,
                                      const VertexTriangles& neighbors, std::uint32_t seed,
                                      std::size_t min_vertices);

}  // namespace mdk
