// Motion decomposition with fuzzy BVHs (Lo09 §4.3): one hierarchy per cluster over its triangles'
// fuzzy boxes, built once and valid at every time. Per frame only the clusters move: K world boxes,
// a median-split hierarchy over them, and K maps for the rays.
#include <vector>

#include "common/base/parallel.h"
#include "common/math/affine_path.h"
#include "common/structures/top_level.h"
#include "common/trace/techniques/makers.h"

namespace mdk {
namespace {

constexpr int kBins = 64;  // built once: quality before speed

/// What a cluster's triangles never leave, in its basis.
std::span<const Aabb> boxes_of(const Model& model, const Cluster& cluster) {
  return model.fuzzy_boxes.subspan(cluster.first_triangle, cluster.triangle_count);
}

class FuzzyBvhTechnique final : public Technique {
 public:
  explicit FuzzyBvhTechnique(const Model& model)
      : model_(model),
        trees_(model.cluster_count()),
        views_(model.cluster_count()),
        world_boxes_(model.cluster_count()) {
    parallel_chunks(trees_.size(), 1, [&](std::size_t begin, std::size_t) {
      trees_[begin] = build_wide_bvh(boxes_of(model, model.clusters[begin]), kBins);
    });
    for (std::size_t c = 0; c < trees_.size(); ++c) {
      views_[c].nodes = trees_[c].nodes;
      views_[c].first_leaf = static_cast<std::uint32_t>(blocks_.size());
      append_blocks(trees_[c], model.triangles, model.clusters[c].first_triangle, blocks_);
    }
  }

  void update(const PosedMesh& mesh) override {
    positions_ = mesh.positions().data();
    at_ = mesh.at();
    for (std::uint32_t c = 0; c < world_boxes_.size(); ++c)
      world_boxes_[c] = cluster_world_box(model_, c, at_);
    build_top_level(world_boxes_, top_);
  }

  void set_view(const PinholeRays& rays) override {
    const std::span<const Affine3f> from = model_.key_maps(at_.key0),
                                    to = model_.key_maps(at_.key1);
    for (std::size_t c = 0; c < views_.size(); ++c)
      views_[c].forms =
          make_frustum_forms(make_frustum_basis(rays, interpolate(from[c], to[c], at_.s)),
                             model_.clusters[c].local_box);
    top_view_.nodes = top_.nodes;
    if (!top_.nodes.empty())
      top_view_.forms = make_frustum_forms(make_frustum_basis(rays), top_.nodes[0].box());
    cache_.begin_frame(blocks_.size());
  }

  void trace(const TileRays& tile, TileHits& hits, TileScratch& scratch,
             TraceCounters* counters) const override {
    trace_tile_two_level_bvh(tile, {top_view_, top_.box_of_leaf, views_},
                             {blocks_, positions_, cache_.usable() ? &cache_ : nullptr}, hits,
                             scratch, counters);
  }

  std::size_t structure_bytes() const override {
    std::size_t bytes = top_.bytes() + blocks_.size() * sizeof(TriangleBlock) + cache_.bytes() +
                        model_.local_from_world.size_bytes() +
                        model_.cluster_world_boxes.size_bytes();
    for (const WideBvh& tree : trees_) bytes += tree.bytes();
    return bytes;
  }

 private:
  const Model& model_;
  KeyInterval at_;
  std::vector<WideBvh> trees_;  ///< by cluster
  std::vector<BvhView> views_;  ///< by cluster
  std::vector<TriangleBlock> blocks_;
  std::vector<Aabb> world_boxes_;
  TopLevel top_;
  BvhView top_view_{};
  const Vec3f* positions_ = nullptr;
  mutable ProjectionCache cache_;
};

}  // namespace

std::unique_ptr<Technique> make_fuzzy_bvh(const Model& model) {
  return std::make_unique<FuzzyBvhTechnique>(model);
}

}  // namespace mdk
