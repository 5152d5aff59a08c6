// Techniques with one world-space hierarchy over the current triangles. They differ only in how the
// hierarchy follows the pose: built anew, refitted, or now the one and now the other.
#include <algorithm>
#include <cassert>

#include "common/structures/bvh.h"
#include "common/trace/cluster_trees.h"
#include "common/trace/techniques/structure_technique.h"

namespace mdk {
namespace {

constexpr int kCarefulBins = 1024;  ///< ahead of time: quality before speed

class BvhTechnique : public StructureTechnique {
 public:
  explicit BvhTechnique(const ModelView& model)
      : StructureTechnique(model), boxes_(model.triangle_count()) {}

  void update(const PosedMesh& mesh) final {
    mesh.positions();
    show(mesh);
    triangle_boxes(mesh, boxes_);
    follow();
    structure<BvhLevels>().top.tree = {bvh_.nodes, 0};
    show_blocks(blocks_);
  }

 protected:
  /// Makes the hierarchy valid for boxes_, the current triangles' boxes.
  virtual void follow() = 0;

  /// A hierarchy over the model's rest pose. Leaves its boxes in boxes_.
  WideBvh build_over_rest_pose() {
    PosedMesh rest(model());
    rest.set_time(at_key(model().rest_key));
    triangle_boxes(rest, boxes_);
    return build_wide_bvh(boxes_, kCarefulBins);
  }

  /// The hierarchy gets other leaves.
  void set_tree(WideBvh&& bvh) {
    bvh_ = std::move(bvh);
    blocks_.clear();
    append_blocks(bvh_, model().triangles, 0, blocks_);
    assert(validate(blocks_, model().triangles).empty());
  }

  std::size_t tree_bytes() const final {
    return bvh_.bytes() + boxes_.size() * sizeof(Aabb) + blocks_.size() * sizeof(TriangleBlock);
  }

  std::vector<Aabb> boxes_;
  WideBvh bvh_;

 private:
  std::vector<TriangleBlock> blocks_;
};

/// A binned SAH hierarchy, built anew for every frame (Lo09 §4.1).
class RebuildBvhTechnique final : public BvhTechnique {
 public:
  using BvhTechnique::BvhTechnique;

 private:
  void follow() override { set_tree(build_wide_bvh(boxes_, 16)); }
};

/// One careful hierarchy over the rest pose; per frame only its boxes follow (Lo09 §4.2).
class RefitBvhTechnique final : public BvhTechnique {
 public:
  using BvhTechnique::BvhTechnique;

  void prebuild(const PosedMesh&) override {
    if (bvh_.nodes.empty()) set_tree(build_over_rest_pose());
  }

 private:
  void follow() override { refit_wide_bvh(bvh_, boxes_); }
};

/// One hierarchy built for the heuristic summed over sampled poses (T-SAH, Bittner and Meister
/// 2015); per frame only its boxes follow.
class TsahRefitTechnique final : public BvhTechnique {
 public:
  using BvhTechnique::BvhTechnique;

  void prebuild(const PosedMesh&) override {
    if (!bvh_.nodes.empty() || boxes_.empty()) return;
    const auto affordable = static_cast<std::uint32_t>(
        std::clamp<std::uint64_t>(kMaxBoxes / boxes_.size(), 2, kMaxPoses));
    const std::uint32_t keys = model().key_count(), poses = std::min(affordable, keys);
    std::vector<Aabb> boxes(boxes_.size() * poses);
    PosedMesh posed(model());
    for (std::uint32_t p = 0; p < poses; ++p) {  // in the middle of equal parts of the keys
      posed.set_time(at_key((2 * p + 1) * keys / (2 * poses)));
      triangle_boxes(posed, std::span(boxes).subspan(p * boxes_.size(), boxes_.size()));
    }
    set_tree(collapse(build_temporal_bvh(
        boxes, poses, {.bins = 32, .intersect_cost = 0.06f, .max_leaf = kLeafItems})));
  }

 private:
  static constexpr std::uint32_t kMaxPoses = 8;
  static constexpr std::uint64_t kMaxBoxes = 2'000'000;  ///< in all poses: large meshes stay quick

  void follow() override { refit_wide_bvh(bvh_, boxes_); }
};

/// Refitted until motion has made it expensive, then built anew (Lo09 §5.4, §6.3). Every frame pays
/// for what its hierarchy has lost since it was built; when these losses together have cost as much
/// as a rebuild would, one is due: never more than about twice the cost of knowing the future.
class HybridBvhTechnique final : public BvhTechnique {
 public:
  using BvhTechnique::BvhTechnique;

  void prebuild(const PosedMesh&) override {
    if (bvh_.nodes.empty()) adopt(build_over_rest_pose());
  }

 private:
  static constexpr int kRebuildBins = 32;
  static constexpr double kRebuildFrames = 8;  ///< what a rebuild costs, in frames of tracing

  void follow() override {
    refit_wide_bvh(bvh_, boxes_);
    if (cost_when_built_ <= 0) return;
    lost_frames_ += std::max(0.0, sah_cost(bvh_) / cost_when_built_ - 1);
    if (lost_frames_ >= kRebuildFrames) adopt(build_wide_bvh(boxes_, kRebuildBins));
  }

  void adopt(WideBvh&& bvh) {
    set_tree(std::move(bvh));
    cost_when_built_ = sah_cost(bvh_);
    lost_frames_ = 0;
  }

  double cost_when_built_ = 0;
  double lost_frames_ = 0;  ///< since then, in frames of tracing
};

/// Refitted, and mended by tree rotations (Kensler 2008) where motion has made it expensive: what
/// the hybrid does by building anew. A pass costs about as much as a frame of tracing loses when it
/// is due; once passes find nothing more, the tree is the best that rotations reach.
class RotateBvhTechnique final : public BvhTechnique {
 public:
  using BvhTechnique::BvhTechnique;

  void prebuild(const PosedMesh&) override {
    if (!bvh_.nodes.empty()) return;
    set_tree(build_over_rest_pose());
    best_cost_ = sah_cost(bvh_);
  }

 private:
  static constexpr double kRotationFrames = 0.1;  ///< what a pass costs, in frames of tracing

  void follow() override {
    refit_wide_bvh(bvh_, boxes_);
    if (best_cost_ <= 0) return;
    lost_frames_ += std::max(0.0, sah_cost(bvh_) / best_cost_ - 1);
    if (lost_frames_ < kRotationFrames) return;
    rotate_wide_bvh(bvh_);
    assert(validate(bvh_, boxes_).empty());
    lost_frames_ = 0;
  }

  double best_cost_ = 0;    ///< of the hierarchy of the rest pose
  double lost_frames_ = 0;  ///< since the last pass, in frames of tracing
};

}  // namespace

std::unique_ptr<Technique> make_rebuild_bvh(const ModelView& model) {
  return std::make_unique<RebuildBvhTechnique>(model);
}
std::unique_ptr<Technique> make_refit_bvh(const ModelView& model) {
  return std::make_unique<RefitBvhTechnique>(model);
}
std::unique_ptr<Technique> make_tsah_refit(const ModelView& model) {
  return std::make_unique<TsahRefitTechnique>(model);
}
std::unique_ptr<Technique> make_rotate_bvh(const ModelView& model) {
  return std::make_unique<RotateBvhTechnique>(model);
}
std::unique_ptr<Technique> make_hybrid_bvh(const ModelView& model) {
  return std::make_unique<HybridBvhTechnique>(model);
}

}  // namespace mdk
