// One careful hierarchy over the rest pose; per frame only its boxes follow (Lo09 §4.2).
#include <vector>

#include "common/structures/bvh.h"
#include "common/trace/techniques/makers.h"

namespace mdk {
namespace {

class RefitBvhTechnique final : public Technique {
 public:
  explicit RefitBvhTechnique(const Model& model) : boxes_(model.triangle_count()) {}

  void prebuild(const PosedMesh& mesh) override {
    if (!bvh_.nodes.empty()) return;
    PosedMesh rest(mesh.model());
    rest.set_time(at_key(mesh.model().rest_key));
    triangle_boxes(rest, boxes_);
    bvh_ = build_bvh(boxes_, {.bins = 1024});
  }
  void update(const PosedMesh& mesh) override {
    soup_ = soup_of(mesh);
    triangle_boxes(mesh, boxes_);
    refit_bvh(bvh_, boxes_);
  }
  void trace(const TileRays& tile, TileHits& hits, TileScratch& scratch,
             TraceCounters* counters) const override {
    trace_tile_bvh(tile, bvh_, soup_, hits, scratch, counters);
  }
  std::size_t structure_bytes() const override {
    return bvh_.bytes() + boxes_.size() * sizeof(Aabb);
  }

 private:
  TriangleSoup soup_{};
  std::vector<Aabb> boxes_;
  Bvh bvh_;
};

}  // namespace

std::unique_ptr<Technique> make_refit_bvh(const Model& model) {
  return std::make_unique<RefitBvhTechnique>(model);
}

}  // namespace mdk
