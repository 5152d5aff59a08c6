// SeenVertices: where the vertices that a picture shows are, and their smooth normals.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/motion/posed_mesh.h"
#include "common/trace/hit_buffer.h"
#include "common/trace/kernels/surface_kernel.h"

namespace mdk {

class SeenVertices {
 public:
  explicit SeenVertices(const Model& model);

  /// The corners of all triangles in those tiles of `hits`, in the present pose. Runs in parallel.
  /// Cost: O(hits + vertices seen); hidden parts of the mesh cost a byte's look per triangle and
  /// vertex, and are not posed.
  void update(const PosedMesh& mesh, const HitBuffer& hits, std::span<const std::uint32_t> tiles);

  /// One per vertex; those of vertices that are not seen are out of date. A normal is zero where
  /// the triangles around the vertex have no direction.
  const SurfaceVertex* data() const { return vertices_.data(); }

 private:
  void mark(const HitBuffer& hits, std::span<const std::uint32_t> tiles);
  SurfaceVertex make(std::uint32_t vertex, const Vec3f* positions) const;

  const Model* model_;
  std::vector<std::uint32_t> first_corner_;  ///< per vertex: where its triangles begin in ring_
  std::vector<std::uint32_t> ring_;
  /// Equal to frame_ where it is seen. One triangle more stands for "no hit".
  std::vector<std::uint8_t> seen_triangles_, seen_vertices_;
  std::uint8_t frame_ = 0;
  std::vector<SurfaceVertex> vertices_;
};

}  // namespace mdk
