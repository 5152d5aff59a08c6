// What techniques with one hierarchy per cluster share: a top level over the clusters' world boxes,
// made anew every frame, and the rays' frusta in every cluster's basis. They differ in how the
// clusters' hierarchies follow the pose.
#pragma once

#include <vector>

#include "common/structures/top_level.h"
#include "common/trace/cluster_trees.h"
#include "common/trace/kernels/beam_kernels.h"
#include "common/trace/techniques/makers.h"

namespace mdk {

class ClusterBvhTechnique : public Technique {
 public:
  explicit ClusterBvhTechnique(const Model& model)
      : model_(model),
        views_(model.cluster_count()),
        world_boxes_(model.cluster_count()),
        maps_(model.cluster_count()) {}

  void update(const PosedMesh& mesh) final;
  void set_view(const PinholeRays& rays) final;
  bool trace(const TileRays& tile, TileHits& hits, TileScratch& scratch,
             TraceCounters* counters) const final;
  void prepare_occlusion() final;
  void occlude(RayBeam& beam, TileScratch& scratch) const final;
  std::size_t structure_bytes() const final;

 protected:
  /// Hierarchies that hold the clusters' present triangles, in their bases.
  virtual const ClusterTrees& follow(const PosedMesh& mesh) = 0;
  virtual std::size_t tree_bytes() const = 0;

  const Model& model() const { return model_; }

 private:
  const Model& model_;
  const ClusterTrees* present_ = nullptr;
  std::vector<BvhView> views_;  ///< by cluster
  std::vector<Aabb> world_boxes_;
  std::vector<Affine3d> maps_;  ///< local_from_world, by cluster
  TopLevel top_;
  BvhView top_view_{};
  std::vector<BeamSpace> beam_spaces_;  ///< by cluster, then the world's
  std::vector<BeamBvh> beam_clusters_;  ///< by cluster
  mutable PosedBlockCache posed_blocks_;
  const PosedMesh* mesh_ = nullptr;
  mutable ProjectionCache cache_;
};

}  // namespace mdk
