// Motion decomposition with a hierarchy per cluster: a top level over the clusters' world boxes is
// made anew every frame, and rays enter each cluster in its own basis. The techniques differ in how
// the clusters' hierarchies follow the pose.
#include "common/base/parallel.h"
#include "common/structures/wide_bvh.h"
#include "common/trace/cluster_trees.h"
#include "common/trace/techniques/structure_technique.h"

namespace mdk {
namespace {

class ClusterBvhTechnique : public StructureTechnique {
 public:
  using StructureTechnique::StructureTechnique;

  void update(const PosedMesh& mesh) final {
    show(mesh);
    const ClusterTrees& current = follow(mesh);
    BvhLevels& levels = structure<BvhLevels>();
    build_top_level(place_clusters(mesh, levels), top_);
    levels.top.tree = {top_.nodes, 0};
    levels.cluster_of_leaf = top_.box_of_leaf;
    for (std::size_t c = 0; c < levels.clusters.size(); ++c)
      levels.clusters[c].tree = {current.trees[c].nodes, current.first_leaf[c]};
    show_blocks(current.blocks);
  }

 protected:
  /// Hierarchies that hold the clusters' current triangles, in their bases.
  virtual const ClusterTrees& follow(const PosedMesh& mesh) = 0;
  virtual std::size_t cluster_tree_bytes() const = 0;

 private:
  std::size_t tree_bytes() const final {
    return top_.bytes() + model().local_from_world.size_bytes() +
           model().cluster_world_boxes.size_bytes() + cluster_tree_bytes();
  }

  TopLevel top_;
};

/// One hierarchy per cluster over its triangles' fuzzy boxes, built once per segment of the time
/// line and valid at all its times (Lo09 §4.3). Per frame only the clusters move.
class FuzzyBvhTechnique final : public ClusterBvhTechnique {
 public:
  explicit FuzzyBvhTechnique(const ModelView& model)
      : ClusterBvhTechnique(model), segments_(model.segment_count()) {}

  void prebuild(const PosedMesh& mesh) override {
    ClusterTrees& trees = current(mesh);
    if (!trees.built()) trees = build_cluster_trees(model(), segment_of(model(), mesh.at()));
  }

 private:
  const ClusterTrees& follow(const PosedMesh& mesh) override { return current(mesh); }
  std::size_t cluster_tree_bytes() const override {
    std::size_t bytes = 0;
    for (const ClusterTrees& segment : segments_) bytes += segment.bytes();
    return bytes;
  }
  ClusterTrees& current(const PosedMesh& mesh) { return segments_[segment_of(model(), mesh.at())]; }

  std::vector<ClusterTrees> segments_;  ///< built when first shown
};

/// Hierarchies that are refitted to what motion the clusters' maps leave at the moment (Lo09 §4.4):
/// the topology of fuzzy-bvh, with boxes as tight as the pose allows.
class DecompRefitTechnique final : public ClusterBvhTechnique {
 public:
  using ClusterBvhTechnique::ClusterBvhTechnique;

  void prebuild(const PosedMesh&) override {
    if (trees_.built()) return;
    trees_ = build_cluster_trees(model(), segment_of(model(), at_key(model().rest_key)));
    boxes_ = LocalBoxes(model());
  }

 private:
  const ClusterTrees& follow(const PosedMesh& mesh) override {
    const Vec3f* positions = mesh.positions().data();
    parallel_chunks(trees_.trees.size(), 1, [&](std::size_t c, std::size_t) {
      const Affine3d map = mesh.cluster_map(static_cast<std::uint32_t>(c));
      refit_wide_bvh(trees_.trees[c], boxes_.find(c, map, positions));
    });
    return trees_;
  }
  std::size_t cluster_tree_bytes() const override { return trees_.bytes() + boxes_.bytes(); }

  ClusterTrees trees_;
  LocalBoxes boxes_;
};

}  // namespace

std::unique_ptr<Technique> make_fuzzy_bvh(const ModelView& model) {
  return std::make_unique<FuzzyBvhTechnique>(model);
}
std::unique_ptr<Technique> make_decomp_refit(const ModelView& model) {
  return std::make_unique<DecompRefitTechnique>(model);
}

}  // namespace mdk
