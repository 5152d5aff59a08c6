// A binned SAH hierarchy over the present triangles, built anew for every frame (Lo09 §4.1).
#include <vector>

#include "common/structures/bvh.h"
#include "common/trace/techniques/makers.h"

namespace mdk {
namespace {

class RebuildBvhTechnique final : public Technique {
 public:
  explicit RebuildBvhTechnique(const Model& model) : boxes_(model.triangle_count()) {}

  void update(const PosedMesh& mesh) override {
    soup_ = soup_of(mesh);
    triangle_boxes(mesh, boxes_);
    bvh_ = build_bvh(boxes_, {.bins = 16});
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

std::unique_ptr<Technique> make_rebuild_bvh(const Model& model) {
  return std::make_unique<RebuildBvhTechnique>(model);
}

}  // namespace mdk
