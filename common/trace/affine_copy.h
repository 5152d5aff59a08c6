// The mesh as its clusters' maps alone would have it (GFW06 Figure 5): what a decomposition
// explains of the motion, and at its cracks and bumps what it does not.
#pragma once

#include <cstdint>
#include <vector>

#include "common/motion/posed_mesh.h"

namespace mdk {

/// A copy of a model whose clusters are rigid bodies in their own bases: each is its rest pose, and
/// the inverse of its map at the moment takes it to the world. Clusters share no vertices in it.
class AffineCopy {
 public:
  /// The model must outlive it. Cost: O(triangles), and decoding the rest pose.
  explicit AffineCopy(const ModelView& model);

  /// A model of one key, the moment of `mesh`, which must be of the model: its triangles with their
  /// numbers, clusters and appearance, without fuzzy boxes and trees. Valid until the next call.
  /// Cost: O(vertices).
  const ModelView& at(const PosedMesh& mesh);

 private:
  std::vector<std::uint32_t> first_vertex_;  ///< K + 1: where the vertices of each cluster begin
  std::vector<Vec3d> local_;                 ///< where each vertex rests in its cluster's basis
  std::vector<Vec3f> positions_;
  std::vector<Triangle> triangles_;
  std::vector<Affine3f> maps_;
  std::vector<QuantizedBox> cluster_boxes_;
  std::vector<Clip> clips_;
  double time_ = 0;
  Segment segment_;
  Aabb box_;
  ModelView copy_;
};

}  // namespace mdk
