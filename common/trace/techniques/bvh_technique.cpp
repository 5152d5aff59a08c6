#include "common/trace/techniques/bvh_technique.h"

namespace mdk {

void BvhTechnique::update(const PosedMesh& mesh) {
  positions_ = mesh.positions().data();
  triangle_boxes(mesh, boxes_);
  follow(mesh.model());
}

WideBvh BvhTechnique::build_over_rest_pose(const Model& model, int bins) {
  PosedMesh rest(model);
  rest.set_time(at_key(model.rest_key));
  triangle_boxes(rest, boxes_);
  return build_wide_bvh(boxes_, bins);
}

void BvhTechnique::set_tree(WideBvh&& bvh, const Model& model) {
  bvh_ = std::move(bvh);
  blocks_.clear();
  append_blocks(bvh_, model.triangles, 0, blocks_);
}

void BvhTechnique::set_view(const PinholeRays& rays) {
  view_.nodes = bvh_.nodes;
  if (!bvh_.nodes.empty())
    view_.forms = make_frustum_forms(make_frustum_basis(rays), bvh_.nodes[0].box());
  cache_.begin_frame(blocks_.size());
}

bool BvhTechnique::trace(const TileRays& tile, TileHits& hits, TileScratch& scratch,
                         TraceCounters* counters) const {
  return trace_tile_bvh(tile, view_, {blocks_, positions_, cache_.usable() ? &cache_ : nullptr},
                        hits, scratch, counters);
}

void BvhTechnique::prepare_occlusion() {
  if (!bvh_.nodes.empty())
    beam_space_ = make_beam_space(Affine3d{}, bvh_.nodes[0].box(), mesh_bounds_);
  posed_blocks_.begin_frame(blocks_.size());
}

void BvhTechnique::occlude(RayBeam& beam, TileScratch&) const {
  occlude_beam_bvh({bvh_.nodes, 0, &beam_space_}, {blocks_, positions_, &posed_blocks_}, beam);
}

std::size_t BvhTechnique::structure_bytes() const {
  return bvh_.bytes() + boxes_.size() * sizeof(Aabb) + blocks_.size() * sizeof(TriangleBlock) +
         cache_.bytes() + posed_blocks_.bytes();
}

}  // namespace mdk
