// Motion decomposition with fuzzy BVHs (Lo09 §4.3): one hierarchy per cluster over its triangles'
// fuzzy boxes, built once per segment of the time line and valid at all its times. Per frame only
// the clusters move: K world boxes, a median-split hierarchy over them, and K maps for the rays.
#include "common/trace/techniques/cluster_bvh_technique.h"

namespace mdk {
namespace {

class FuzzyBvhTechnique final : public ClusterBvhTechnique {
 public:
  explicit FuzzyBvhTechnique(const Model& model)
      : ClusterBvhTechnique(model), segments_(model.segment_count()) {}

  void prebuild(const PosedMesh& mesh) override {
    const std::uint32_t segment = segment_of(model(), mesh.at());
    if (!segments_[segment].built()) segments_[segment] = build_cluster_trees(model(), segment);
  }

 private:
  const ClusterTrees& follow(const PosedMesh& mesh) override {
    return segments_[segment_of(model(), mesh.at())];
  }
  std::size_t tree_bytes() const override {
    std::size_t bytes = 0;
    for (const ClusterTrees& segment : segments_) bytes += segment.bytes();
    return bytes;
  }

  std::vector<ClusterTrees> segments_;  ///< built when first shown
};

}  // namespace

std::unique_ptr<Technique> make_fuzzy_bvh(const Model& model) {
  return std::make_unique<FuzzyBvhTechnique>(model);
}

}  // namespace mdk
