// A kd-tree built ahead of time for every pose that is shown, then only swapped in: the baseline of
// GFW06 Table 1. It costs a tree per key; between keys one is built for that very moment, and
// counts as prebuilt all the same.
#include <map>
#include <tuple>
#include <vector>

#include "common/structures/kd_tree_builder.h"
#include "common/trace/kernels/beam_kernels.h"
#include "common/trace/techniques/makers.h"

namespace mdk {
namespace {

class StaticKdTechnique final : public Technique {
 public:
  void prebuild(const PosedMesh& mesh) override {
    const bool passing = is_passing(mesh);
    std::map<Moment, KdTree>& trees = passing ? between_keys_ : at_keys_;
    const Moment moment = moment_of(mesh);
    if (trees.contains(moment) && !mesh.is_live()) return;
    if (passing) between_keys_.clear();  // only the present one: their number has no end
    std::vector<Aabb> boxes(mesh.model().triangle_count());
    triangle_boxes(mesh, boxes);
    trees.emplace(moment, build_kd_tree(boxes));
  }
  void update(const PosedMesh& mesh) override {
    soup_ = soup_of(mesh);
    mesh_bounds_ = mesh.model().bounds;
    present_.tree = (is_passing(mesh) ? between_keys_ : at_keys_).at(moment_of(mesh)).view();
  }
  void set_view(const PinholeRays& rays) override {
    present_.forms = make_frustum_forms(make_frustum_basis(rays), present_.tree.bounds);
  }
  bool trace(const TileRays& tile, TileHits& hits, TileScratch& scratch,
             TraceCounters* counters) const override {
    return trace_tile_kd(tile, present_, soup_, hits, scratch, counters);
  }
  void prepare_occlusion() override {
    beam_space_ = make_beam_space(Affine3d{}, present_.tree.bounds, mesh_bounds_);
  }
  void occlude(RayBeam& beam, TileScratch& scratch) const override {
    occlude_beam_kd({present_.tree, &beam_space_}, soup_, beam, scratch);
  }
  std::size_t structure_bytes() const override {
    std::size_t bytes = 0;
    for (const auto* trees : {&at_keys_, &between_keys_})
      for (const auto& [moment, tree] : *trees) bytes += tree.bytes();
    return bytes;
  }

 private:
  using Moment = std::tuple<std::uint32_t, std::uint32_t, float>;

  /// Between keys, or posed by hand.
  static bool is_passing(const PosedMesh& mesh) { return mesh.is_live() || mesh.at().s != 0.0f; }
  static Moment moment_of(const PosedMesh& mesh) {
    return {mesh.at().key0, mesh.at().key1, mesh.at().s};
  }

  TriangleSoup soup_{};
  std::map<Moment, KdTree> at_keys_, between_keys_;
  KdView present_;
  BeamSpace beam_space_;
  Aabb mesh_bounds_;  ///< at all times
};

}  // namespace

std::unique_ptr<Technique> make_static_kdtree(const Model&) {
  return std::make_unique<StaticKdTechnique>();
}

}  // namespace mdk
