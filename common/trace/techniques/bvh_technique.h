// What techniques with one world-space hierarchy over the present triangles share: they differ only
// in how the hierarchy follows the pose.
#pragma once

#include <vector>

#include "common/structures/wide_bvh.h"
#include "common/trace/kernels/beam_kernels.h"
#include "common/trace/techniques/makers.h"

namespace mdk {

class BvhTechnique : public Technique {
 public:
  explicit BvhTechnique(const Model& model)
      : boxes_(model.triangle_count()), mesh_bounds_(model.bounds) {}

  void update(const PosedMesh& mesh) final;
  void set_view(const PinholeRays& rays) final;
  bool trace(const TileRays& tile, TileHits& hits, TileScratch& scratch,
             TraceCounters* counters) const final;
  void prepare_occlusion() final;
  void occlude(RayBeam& beam, TileScratch& scratch) const final;
  std::size_t structure_bytes() const final;

 protected:
  /// Makes the hierarchy valid for boxes_, the present triangles' boxes.
  virtual void follow(const Model& model) = 0;

  /// A hierarchy over the model's rest pose. Leaves its boxes in boxes_.
  WideBvh build_over_rest_pose(const Model& model, int bins);

  /// The hierarchy gets other leaves.
  void set_tree(WideBvh&& bvh, const Model& model);

  std::vector<Aabb> boxes_;
  WideBvh bvh_;

 private:
  std::vector<TriangleBlock> blocks_;
  const Vec3f* positions_ = nullptr;
  Aabb mesh_bounds_;  ///< at all times
  BvhView view_{};
  BeamSpace beam_space_;
  mutable PosedBlockCache posed_blocks_;
  mutable ProjectionCache cache_;
};

}  // namespace mdk
