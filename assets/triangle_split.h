// Finer meshes: every triangle becomes four.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "assets/glb_writer.h"
#include "assets/sample_sequence.h"

namespace mdk {

/// The triangles once split, and the two old vertices that each new one lies between; new vertices
/// are numbered from the count of the old ones.
struct TriangleSplit {
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::array<std::uint32_t, 2>> parents;
};
TriangleSplit split_triangles(const std::vector<std::array<std::uint32_t, 3>>& triangles,
                              std::size_t vertex_count);

/// `mesh` with its triangles split: new vertices in the middle, with the mean of the normals,
/// colours and joint weights (at most the four largest).
void split_mesh(GlbMesh& mesh);

/// The same at every key.
void split_sequence(SampleSequence& sequence);

}  // namespace mdk
