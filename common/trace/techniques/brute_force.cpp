// No structure at all: what every other technique is judged by.
#include "common/trace/kernels/beam_kernels.h"
#include "common/trace/techniques/makers.h"

namespace mdk {
namespace {

class BruteForceTechnique final : public Technique {
 public:
  void update(const PosedMesh& mesh) override { soup_ = soup_of(mesh); }
  bool trace(const TileRays& tile, TileHits& hits, TileScratch& scratch,
             TraceCounters* counters) const override {
    return trace_tile_brute_force(tile, soup_, hits, scratch, counters);
  }
  void occlude(RayBeam& beam, TileScratch&) const override {
    occlude_beam_brute_force(soup_, beam);
  }
  std::size_t structure_bytes() const override { return 0; }

 private:
  TriangleSoup soup_{};
};

}  // namespace

std::unique_ptr<Technique> make_brute_force(const Model&) {
  return std::make_unique<BruteForceTechnique>();
}

}  // namespace mdk
