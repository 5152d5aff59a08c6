// Techniques with kd-trees, whose leaves name triangles or clusters that may reach into others.
#include <map>
#include <tuple>

#include "common/structures/kd_tree.h"
#include "common/trace/techniques/structure_technique.h"

namespace mdk {
namespace {

/// Motion decomposition with fuzzy kd-trees (GFW06). The trees stand in the model and never change;
/// per frame only the clusters move: K world boxes, a small kd-tree over them, and K maps for the
/// rays. Where the time line has segments, the current one's trees are swapped in.
class FuzzyKdTechnique final : public StructureTechnique {
 public:
  using StructureTechnique::StructureTechnique;

  void update(const PosedMesh& mesh) override {
    show(mesh);
    KdLevels& levels = structure<KdLevels>();
    top_ = build_kd_tree(place_clusters(mesh, levels));
    levels.top.tree = top_.view();
    const std::span<const FuzzyTree> trees = model().segment_trees(segment_of(model(), mesh.at()));
    for (std::size_t c = 0; c < levels.clusters.size(); ++c)
      levels.clusters[c].tree = model().tree_view(trees[c]);
  }

 private:
  std::size_t tree_bytes() const override {
    return model().kd_nodes.size_bytes() + model().kd_refs.size_bytes() +
           model().local_from_world.size_bytes() + model().cluster_world_boxes.size_bytes() +
           top_.bytes();
  }

  KdTree top_;
};

/// A kd-tree built ahead of time for every pose that is shown, then only swapped in: the baseline
/// of GFW06 Table 1. It costs a tree per key; between keys one is built for that very moment, and
/// counts as prebuilt all the same.
class StaticKdTechnique final : public StructureTechnique {
 public:
  using StructureTechnique::StructureTechnique;

  void prebuild(const PosedMesh& mesh) override {
    std::map<Moment, KdTree>& trees = trees_of(mesh);
    const Moment moment = moment_of(mesh);
    if (trees.contains(moment) && !mesh.is_live()) return;
    if (&trees == &between_keys_) trees.clear();  // only the current one: their number has no end
    std::vector<Aabb> boxes(model().triangle_count());
    triangle_boxes(mesh, boxes);
    trees.emplace(moment, build_kd_tree(boxes, 0, kTriangleTreeConfig));
  }
  void update(const PosedMesh& mesh) override {
    mesh.positions();
    show(mesh);
    structure<KdLevels>().top.tree = trees_of(mesh).at(moment_of(mesh)).view();
  }

 private:
  using Moment = std::tuple<std::uint32_t, std::uint32_t, float>;

  std::size_t tree_bytes() const override {
    std::size_t bytes = 0;
    for (const auto* trees : {&at_keys_, &between_keys_})
      for (const auto& [moment, tree] : *trees) bytes += tree.bytes();
    return bytes;
  }
  static Moment moment_of(const PosedMesh& mesh) {
    return {mesh.at().key0, mesh.at().key1, mesh.at().s};
  }
  std::map<Moment, KdTree>& trees_of(const PosedMesh& mesh) {
    return mesh.is_live() || mesh.at().s != 0.0f ? between_keys_ : at_keys_;
  }

  std::map<Moment, KdTree> at_keys_;
  std::map<Moment, KdTree> between_keys_;  ///< or posed by hand
};

}  // namespace

std::unique_ptr<Technique> make_fuzzy_kdtree(const ModelView& model) {
  return std::make_unique<FuzzyKdTechnique>(model);
}
std::unique_ptr<Technique> make_static_kdtree(const ModelView& model) {
  return std::make_unique<StaticKdTechnique>(model);
}

}  // namespace mdk
