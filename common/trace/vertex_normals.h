// VertexNormals: smooth normals of the vertices that a picture shows.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/motion/posed_mesh.h"
#include "common/trace/hit_buffer.h"

namespace mdk {

class VertexNormals {
 public:
  explicit VertexNormals(const Model& model);

  /// Normals of the corners of all triangles in those tiles of `hits`, in the present pose. Runs in
  /// parallel.
  /// Cost: O(hits + vertices seen); hidden parts of the mesh cost a byte's look per vertex.
  void update(const PosedMesh& mesh, const HitBuffer& hits, std::span<const std::uint32_t> tiles);

  /// One per vertex: of unit length, or zero where the triangles around it have no direction; those
  /// of vertices that are not seen are out of date.
  const Vec3f* data() const { return normals_.data(); }

 private:
  void mark_seen(const HitBuffer& hits, std::span<const std::uint32_t> tiles);

  const Model* model_;
  std::vector<std::uint32_t> first_corner_;  ///< per vertex: where its triangles begin in ring_
  std::vector<std::uint32_t> ring_;
  std::vector<std::uint8_t> seen_;  ///< per vertex: equal to frame_ where it is seen
  std::uint8_t frame_ = 0;
  std::vector<Vec3f> normals_;
};

}  // namespace mdk
