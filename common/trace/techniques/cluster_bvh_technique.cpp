#include "common/trace/techniques/cluster_bvh_technique.h"

namespace mdk {

void ClusterBvhTechnique::update(const PosedMesh& mesh) {
  mesh_ = &mesh;
  present_ = &follow(mesh);
  for (std::uint32_t c = 0; c < world_boxes_.size(); ++c) {
    world_boxes_[c] = mesh.cluster_box(c);
    maps_[c] = mesh.cluster_map(c);
  }
  build_top_level(world_boxes_, top_);
}

void ClusterBvhTechnique::set_view(const PinholeRays& rays) {
  for (std::size_t c = 0; c < views_.size(); ++c) {
    const std::vector<WideBvhNode>& nodes = present_->trees[c].nodes;
    if (nodes.empty()) continue;
    const FrustumBasis basis = make_frustum_basis(rays, maps_[c]);
    views_[c] = {nodes, present_->first_leaf[c], make_frustum_forms(basis, nodes[0].box())};
  }
  top_view_.nodes = top_.nodes;
  if (!top_.nodes.empty())
    top_view_.forms = make_frustum_forms(make_frustum_basis(rays), top_.nodes[0].box());
  cache_.begin_frame(present_->blocks.size());
}

bool ClusterBvhTechnique::trace(const TileRays& tile, TileHits& hits, TileScratch& scratch,
                                TraceCounters* counters) const {
  return trace_tile_two_level_bvh(
      tile, {top_view_, top_.box_of_leaf, views_, *mesh_},
      {present_->blocks, mesh_->posed_so_far(), cache_.usable() ? &cache_ : nullptr}, hits, scratch,
      counters);
}

void ClusterBvhTechnique::prepare_occlusion() {
  mesh_->positions();  // beams come everywhere
  const std::size_t count = views_.size();
  beam_spaces_.resize(count + 1);
  beam_clusters_.resize(count);
  for (std::size_t c = 0; c < count; ++c) {
    const std::vector<WideBvhNode>& nodes = present_->trees[c].nodes;
    if (nodes.empty()) continue;
    beam_spaces_[c] = make_beam_space(maps_[c], nodes[0].box(), model_.bounds);
    beam_clusters_[c] = {nodes, present_->first_leaf[c], &beam_spaces_[c]};
  }
  if (!top_.nodes.empty())
    beam_spaces_[count] = make_beam_space(Affine3d{}, top_.nodes[0].box(), model_.bounds);
  posed_blocks_.begin_frame(present_->blocks.size());
}

void ClusterBvhTechnique::occlude(RayBeam& beam, TileScratch&) const {
  const BeamBvh top{top_.nodes, 0, &beam_spaces_.back()};
  occlude_beam_two_level_bvh({top, top_.box_of_leaf, beam_clusters_},
                             {present_->blocks, mesh_->posed_so_far(), &posed_blocks_}, beam);
}

std::size_t ClusterBvhTechnique::structure_bytes() const {
  return top_.bytes() + cache_.bytes() + posed_blocks_.bytes() +
         model_.local_from_world.size_bytes() + model_.cluster_world_boxes.size_bytes() +
         tree_bytes();
}

}  // namespace mdk
