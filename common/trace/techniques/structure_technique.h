// What all techniques of ours share: rays walk a structure of one or two levels, and a frame works
// its leaves out once. They differ in the structure and in how it follows the pose; without one it
// is brute force.
#pragma once

#include <memory>

#include "common/trace/technique.h"

namespace mdk {

class StructureTechnique : public Technique {
 public:
  explicit StructureTechnique(const ModelView& model) : model_(model) {}
  StructureTechnique(const StructureTechnique&) = delete;
  StructureTechnique& operator=(const StructureTechnique&) = delete;

  void set_view(const PinholeRays& rays) final;
  bool trace(const TileRays& tile, TileHits& hits, TileScratch& scratch,
             TraceCounters* counters) const final {
    return trace_tile(tile, scene_, hits, scratch, counters);
  }
  void prepare_occlusion() final;
  void occlude(RayBeam& beam, TileScratch& scratch) const final {
    occlude_beam(scene_, beam, scratch);
  }
  std::size_t structure_bytes() const final;

 protected:
  /// Memory of the structure, in bytes.
  virtual std::size_t tree_bytes() const = 0;

  const ModelView& model() const { return model_; }

  /// Rays find the triangles of `mesh`. Those of structures with clusters need not be posed yet.
  void show(const PosedMesh& mesh);
  /// The blocks of all leaves of hierarchies.
  void show_blocks(std::span<const TriangleBlock> blocks) { scene_.blocks = blocks; }

  /// The structure, to be kept valid by update(): BvhLevels or KdLevels.
  template <class Structure>
  Structure& structure() {
    if (!std::holds_alternative<Structure>(scene_.structure))
      scene_.structure.template emplace<Structure>();
    return std::get<Structure>(scene_.structure);
  }
  /// The clusters of `levels` have their current maps. Returns their world boxes.
  template <class Tree>
  std::span<const Aabb> place_clusters(const PosedMesh& mesh, Levels<Tree>& levels) {
    levels.clusters.resize(model_.cluster_count());
    world_boxes_.resize(model_.cluster_count());
    for (std::uint32_t c = 0; c < model_.cluster_count(); ++c) {
      world_boxes_[c] = mesh.cluster_box(c);
      levels.clusters[c].local_from_world = mesh.cluster_map(c);
    }
    return world_boxes_;
  }

 private:
  template <class Visit>
  void for_each_level(const Visit& visit);

  const ModelView& model_;
  TraceScene scene_;
  std::vector<Aabb> world_boxes_;  ///< by cluster
  ProjectionCache projected_blocks_;
  PosedBlockCache posed_blocks_;
};

// One maker per technique; the table is their only caller.
std::unique_ptr<Technique> make_brute_force(const ModelView& model);
std::unique_ptr<Technique> make_decomp_refit(const ModelView& model);
std::unique_ptr<Technique> make_embree(const ModelView& model);      ///< only with MDK_HAVE_EMBREE
std::unique_ptr<Technique> make_embree_low(const ModelView& model);  ///< "
std::unique_ptr<Technique> make_embree_medium(const ModelView& model);  ///< "
std::unique_ptr<Technique> make_embree_refit(const ModelView& model);   ///< "
std::unique_ptr<Technique> make_fuzzy_bvh(const ModelView& model);
std::unique_ptr<Technique> make_fuzzy_kdtree(const ModelView& model);
std::unique_ptr<Technique> make_hybrid_bvh(const ModelView& model);
std::unique_ptr<Technique> make_rebuild_bvh(const ModelView& model);
std::unique_ptr<Technique> make_refit_bvh(const ModelView& model);
std::unique_ptr<Technique> make_rotate_bvh(const ModelView& model);
std::unique_ptr<Technique> make_static_kdtree(const ModelView& model);
std::unique_ptr<Technique> make_tsah_refit(const ModelView& model);

}  // namespace mdk
