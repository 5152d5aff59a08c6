// What techniques with one world-space hierarchy over the present triangles share: they differ only
// in how the hierarchy follows the pose.
#pragma once

#include <vector>

#include "common/structures/bvh.h"
#include "common/trace/techniques/makers.h"

namespace mdk {

class BvhTechnique : public Technique {
 public:
  explicit BvhTechnique(const Model& model) : boxes_(model.triangle_count()) {}

  void update(const PosedMesh& mesh) final {
    soup_ = soup_of(mesh);
    triangle_boxes(mesh, boxes_);
    follow();
  }
  void trace(const TileRays& tile, TileHits& hits, TileScratch& scratch,
             TraceCounters* counters) const final {
    trace_tile_bvh(tile, bvh_, soup_, hits, scratch, counters);
  }
  std::size_t structure_bytes() const final { return bvh_.bytes() + boxes_.size() * sizeof(Aabb); }

 protected:
  /// Makes bvh_ valid for boxes_, the present triangles' boxes.
  virtual void follow() = 0;

  std::vector<Aabb> boxes_;
  Bvh bvh_;

 private:
  TriangleSoup soup_{};
};

}  // namespace mdk
