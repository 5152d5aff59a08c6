// One hierarchy built for the heuristic summed over sampled poses (T-SAH, Bittner and Meister
// 2015); per frame only its boxes follow.
#include <algorithm>

#include "common/structures/temporal_bvh.h"
#include "common/trace/techniques/bvh_technique.h"

namespace mdk {
namespace {

constexpr std::uint32_t kMostPoses = 8;
constexpr std::uint64_t kMostBoxes = 2'000'000;  ///< in all poses, so that large meshes stay quick

class TsahRefitTechnique final : public BvhTechnique {
 public:
  using BvhTechnique::BvhTechnique;

  void prebuild(const PosedMesh& mesh) override {
    const Model& model = mesh.model();
    if (!bvh_.nodes.empty() || boxes_.empty()) return;
    const auto affordable =
        static_cast<std::uint32_t>(std::clamp<std::uint64_t>(kMostBoxes / boxes_.size(), 2, 8));
    const std::uint32_t poses = std::min({kMostPoses, affordable, model.key_count()});
    std::vector<Aabb> boxes(boxes_.size() * poses);
    PosedMesh posed(model);
    for (std::uint32_t p = 0; p < poses; ++p) {  // in the middle of equal parts of the keys
      posed.set_time(at_key((2 * p + 1) * model.key_count() / (2 * poses)));
      triangle_boxes(posed, std::span(boxes).subspan(p * boxes_.size(), boxes_.size()));
    }
    set_tree(collapse(build_temporal_bvh(
                 boxes, poses, {.bins = 32, .intersect_cost = 0.06f, .max_leaf = kLeafItems})),
             model);
  }

 private:
  void follow(const Model&) override { refit_wide_bvh(bvh_, boxes_); }
};

}  // namespace

std::unique_ptr<Technique> make_tsah_refit(const Model& model) {
  return std::make_unique<TsahRefitTechnique>(model);
}

}  // namespace mdk
