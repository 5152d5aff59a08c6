// Motion decomposition with fuzzy BVHs (Lo09 §4.3): one hierarchy per cluster over its triangles'
// fuzzy boxes, built once per segment of the time line and valid at all its times. Per frame only
// the clusters move: K world boxes, a median-split hierarchy over them, and K maps for the rays.
#include <vector>

#include "common/base/parallel.h"
#include "common/structures/top_level.h"
#include "common/trace/techniques/makers.h"

namespace mdk {
namespace {

constexpr int kBins = 64;  // built once: quality before speed

/// The hierarchies of one segment: valid at all its times.
struct SegmentTrees {
  std::vector<WideBvh> trees;             ///< by cluster
  std::vector<std::uint32_t> first_leaf;  ///< by cluster: where its blocks begin
  std::vector<TriangleBlock> blocks;      ///< of all leaves, cluster by cluster

  bool built() const { return !trees.empty(); }
  std::size_t bytes() const {
    std::size_t sum = blocks.size() * sizeof(TriangleBlock);
    for (const WideBvh& tree : trees) sum += tree.bytes();
    return sum;
  }
};

SegmentTrees build_trees(const Model& model, std::uint32_t segment) {
  SegmentTrees built;
  built.trees.resize(model.cluster_count());
  const std::span<const Aabb> boxes = model.segment_boxes(segment);
  parallel_chunks(built.trees.size(), 1, [&](std::size_t c, std::size_t) {
    const Cluster& cluster = model.clusters[c];
    built.trees[c] =
        build_wide_bvh(boxes.subspan(cluster.first_triangle, cluster.triangle_count), kBins);
  });
  for (std::size_t c = 0; c < built.trees.size(); ++c) {
    built.first_leaf.push_back(static_cast<std::uint32_t>(built.blocks.size()));
    append_blocks(built.trees[c], model.triangles, model.clusters[c].first_triangle, built.blocks);
  }
  return built;
}

class FuzzyBvhTechnique final : public Technique {
 public:
  explicit FuzzyBvhTechnique(const Model& model)
      : model_(model),
        segments_(model.segment_count()),
        views_(model.cluster_count()),
        world_boxes_(model.cluster_count()),
        maps_(model.cluster_count()) {}

  void prebuild(const PosedMesh& mesh) override {
    const std::uint32_t segment = segment_of(model_, mesh.at());
    if (!segments_[segment].built()) segments_[segment] = build_trees(model_, segment);
  }

  void update(const PosedMesh& mesh) override {
    positions_ = mesh.positions().data();
    present_ = &segments_[segment_of(model_, mesh.at())];
    for (std::uint32_t c = 0; c < world_boxes_.size(); ++c) {
      world_boxes_[c] = mesh.cluster_box(c);
      maps_[c] = mesh.cluster_map(c);
    }
    build_top_level(world_boxes_, top_);
  }

  void set_view(const PinholeRays& rays) override {
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

  void trace(const TileRays& tile, TileHits& hits, TileScratch& scratch,
             TraceCounters* counters) const override {
    trace_tile_two_level_bvh(tile, {top_view_, top_.box_of_leaf, views_},
                             {present_->blocks, positions_, cache_.usable() ? &cache_ : nullptr},
                             hits, scratch, counters);
  }

  std::size_t structure_bytes() const override {
    std::size_t bytes = top_.bytes() + cache_.bytes() + model_.local_from_world.size_bytes() +
                        model_.cluster_world_boxes.size_bytes();
    for (const SegmentTrees& segment : segments_) bytes += segment.bytes();
    return bytes;
  }

 private:
  const Model& model_;
  std::vector<SegmentTrees> segments_;  ///< built when first shown
  const SegmentTrees* present_ = nullptr;
  std::vector<BvhView> views_;  ///< by cluster
  std::vector<Aabb> world_boxes_;
  std::vector<Affine3d> maps_;  ///< by cluster
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
