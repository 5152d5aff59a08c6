// One careful hierarchy over the rest pose; per frame only its boxes follow (Lo09 §4.2).
#include "common/trace/techniques/bvh_technique.h"

namespace mdk {
namespace {

class RefitBvhTechnique final : public BvhTechnique {
 public:
  using BvhTechnique::BvhTechnique;

  void prebuild(const PosedMesh& mesh) override {
    if (bvh_.nodes.empty()) set_tree(build_over_rest_pose(mesh.model(), 1024), mesh.model());
  }

 private:
  void follow(const Model&) override { refit_wide_bvh(bvh_, boxes_); }
};

}  // namespace

std::unique_ptr<Technique> make_refit_bvh(const Model& model) {
  return std::make_unique<RefitBvhTechnique>(model);
}

}  // namespace mdk
