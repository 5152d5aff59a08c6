// A binned SAH hierarchy over the present triangles, built anew for every frame (Lo09 §4.1).
#include "common/trace/techniques/bvh_technique.h"

namespace mdk {
namespace {

class RebuildBvhTechnique final : public BvhTechnique {
 public:
  using BvhTechnique::BvhTechnique;

 private:
  void follow(const Model& model) override { set_tree(build_wide_bvh(boxes_, 16), model); }
};

}  // namespace

std::unique_ptr<Technique> make_rebuild_bvh(const Model& model) {
  return std::make_unique<RebuildBvhTechnique>(model);
}

}  // namespace mdk
