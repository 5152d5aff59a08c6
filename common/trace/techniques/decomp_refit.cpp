// Motion decomposition with hierarchies that are refitted to what motion the clusters' maps leave
// at present (Lo09 §4.4): the topology of fuzzy-bvh, with boxes as tight as the pose allows.
#include <limits>

#include "common/base/parallel.h"
#include "common/trace/techniques/cluster_bvh_technique.h"

namespace mdk {
namespace {

/// The triangle's box in a cluster's basis. As triangle_boxes(): a point where a corner is not
/// finite, since such a triangle cannot be hit.
Aabb local_box(const Affine3d& local_from_world, const Triangle& triangle, const Vec3f* positions) {
  constexpr double kMax = std::numeric_limits<float>::max();
  Aabbd box;
  bool is_finite = true;
  for (const std::uint32_t v : triangle.v) {
    const Vec3d p = local_from_world.point(to_double(positions[v]));
    is_finite = is_finite && std::abs(p.x) < kMax && std::abs(p.y) < kMax && std::abs(p.z) < kMax;
    box.extend(p);
  }
  return is_finite ? round_outward(box) : Aabb{{0, 0, 0}, {0, 0, 0}};
}

class DecompRefitTechnique final : public ClusterBvhTechnique {
 public:
  explicit DecompRefitTechnique(const Model& model)
      : ClusterBvhTechnique(model), boxes_(model.triangle_count()) {}

  void prebuild(const PosedMesh&) override {
    if (!trees_.built())
      trees_ = build_cluster_trees(model(), segment_of(model(), at_key(model().rest_key)));
  }

 private:
  const ClusterTrees& follow(const PosedMesh& mesh) override {
    const Vec3f* positions = mesh.positions().data();
    parallel_chunks(trees_.trees.size(), 1, [&](std::size_t c, std::size_t) {
      const Affine3d map = mesh.cluster_map(static_cast<std::uint32_t>(c));
      const Cluster& cluster = model().clusters[c];
      const std::span<Aabb> boxes =
          std::span(boxes_).subspan(cluster.first_triangle, cluster.triangle_count);
      for (std::size_t i = 0; i < boxes.size(); ++i)
        boxes[i] = local_box(map, model().triangles[cluster.first_triangle + i], positions);
      refit_wide_bvh(trees_.trees[c], boxes);
    });
    return trees_;
  }
  std::size_t tree_bytes() const override { return trees_.bytes() + boxes_.size() * sizeof(Aabb); }

  ClusterTrees trees_;
  std::vector<Aabb> boxes_;  ///< of the present triangles, in their clusters' bases
};

}  // namespace

std::unique_ptr<Technique> make_decomp_refit(const Model& model) {
  return std::make_unique<DecompRefitTechnique>(model);
}

}  // namespace mdk
