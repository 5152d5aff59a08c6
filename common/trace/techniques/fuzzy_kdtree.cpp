// Motion decomposition with fuzzy kd-trees (GFW06). The trees stand in the model and never change;
// per frame only the clusters move: K world boxes, a small kd-tree over them, and K maps for the
// rays. Where the time line has segments, the present one's trees are swapped in.
#include <vector>

#include "common/structures/kd_tree_builder.h"
#include "common/trace/kernels/beam_kernels.h"
#include "common/trace/techniques/makers.h"

namespace mdk {
namespace {

class FuzzyKdTechnique final : public Technique {
 public:
  explicit FuzzyKdTechnique(const Model& model)
      : model_(model),
        world_boxes_(model.cluster_count()),
        maps_(model.cluster_count()),
        clusters_(model.cluster_count()) {}

  void update(const PosedMesh& mesh) override {
    mesh_ = &mesh;
    for (std::uint32_t c = 0; c < world_boxes_.size(); ++c) {
      world_boxes_[c] = mesh.cluster_box(c);
      maps_[c] = mesh.cluster_map(c);
    }
    top_ = build_kd_tree(world_boxes_);
    const std::span<const FuzzyTree> trees = model_.segment_trees(segment_of(model_, mesh.at()));
    for (std::size_t c = 0; c < clusters_.size(); ++c)
      clusters_[c].tree = model_.tree_view(trees[c]);
  }

  void set_view(const PinholeRays& rays) override {
    for (std::size_t c = 0; c < clusters_.size(); ++c)
      clusters_[c].forms =
          make_frustum_forms(make_frustum_basis(rays, maps_[c]), clusters_[c].tree.bounds);
    top_view_ = {top_.view(), make_frustum_forms(make_frustum_basis(rays), top_.bounds)};
  }

  bool trace(const TileRays& tile, TileHits& hits, TileScratch& scratch,
             TraceCounters* counters) const override {
    return trace_tile_two_level_kd(tile, {top_view_, clusters_, *mesh_}, soup(), hits, scratch,
                                   counters);
  }

  void prepare_occlusion() override {
    mesh_->positions();  // beams come everywhere
    const std::size_t count = clusters_.size();
    beam_spaces_.resize(count + 1);
    beam_clusters_.resize(count);
    for (std::size_t c = 0; c < count; ++c) {
      beam_spaces_[c] = make_beam_space(maps_[c], clusters_[c].tree.bounds, model_.bounds);
      beam_clusters_[c] = {clusters_[c].tree, &beam_spaces_[c]};
    }
    beam_spaces_[count] = make_beam_space(Affine3d{}, top_.bounds, model_.bounds);
  }

  void occlude(RayBeam& beam, TileScratch& scratch) const override {
    occlude_beam_two_level_kd({top_.view(), &beam_spaces_.back()}, beam_clusters_, soup(), beam,
                              scratch);
  }

  std::size_t structure_bytes() const override {
    return model_.kd_nodes.size_bytes() + model_.kd_refs.size_bytes() +
           model_.local_from_world.size_bytes() + model_.cluster_world_boxes.size_bytes() +
           top_.bytes();
  }

 private:
  TriangleSoup soup() const {
    return {model_.triangles.data(), mesh_->posed_so_far(), model_.triangle_count()};
  }

  const Model& model_;
  const PosedMesh* mesh_ = nullptr;
  std::vector<Aabb> world_boxes_;
  std::vector<Affine3d> maps_;
  KdTree top_;
  KdView top_view_;
  std::vector<KdView> clusters_;
  std::vector<BeamSpace> beam_spaces_;  ///< by cluster, then the world's
  std::vector<BeamKd> beam_clusters_;
};

}  // namespace

std::unique_ptr<Technique> make_fuzzy_kdtree(const Model& model) {
  return std::make_unique<FuzzyKdTechnique>(model);
}

}  // namespace mdk
