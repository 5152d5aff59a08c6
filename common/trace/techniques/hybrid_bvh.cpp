// A hierarchy that is refitted until motion has spoilt it, then built anew (Lo09 §5.4, §6.3). Every
// frame pays for what its hierarchy has lost since it was built; when these losses together have
// cost as much as a rebuild would, one is due: never more than about twice the cost of knowing the
// future.
#include <algorithm>

#include "common/trace/techniques/bvh_technique.h"

namespace mdk {
namespace {

constexpr int kFirstBins = 1024;  // ahead of time: quality before speed
constexpr int kRebuildBins = 32;
constexpr double kRebuildFrames = 8;  ///< what a rebuild costs, in frames of tracing

class HybridBvhTechnique final : public BvhTechnique {
 public:
  using BvhTechnique::BvhTechnique;

  void prebuild(const PosedMesh& mesh) override {
    if (bvh_.nodes.empty()) adopt(build_over_rest_pose(mesh.model(), kFirstBins), mesh.model());
  }

 private:
  void follow(const Model& model) override {
    refit_wide_bvh(bvh_, boxes_);
    if (cost_when_built_ <= 0) return;
    lost_frames_ += std::max(0.0, sah_cost(bvh_) / cost_when_built_ - 1);
    if (lost_frames_ >= kRebuildFrames) adopt(build_wide_bvh(boxes_, kRebuildBins), model);
  }

  void adopt(WideBvh&& bvh, const Model& model) {
    set_tree(std::move(bvh), model);
    cost_when_built_ = sah_cost(bvh_);
    lost_frames_ = 0;
  }

  double cost_when_built_ = 0;
  double lost_frames_ = 0;  ///< since then, in frames of tracing
};

}  // namespace

std::unique_ptr<Technique> make_hybrid_bvh(const Model& model) {
  return std::make_unique<HybridBvhTechnique>(model);
}

}  // namespace mdk
