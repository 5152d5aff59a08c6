// Clusters of the open file: what is known of each, which are shown, and the model of those.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "common/motion/model.h"

namespace mdk {

/// What a file says about one of its clusters.
struct ClusterFacts {
  std::uint32_t triangles = 0;
  double residual = 0;  ///< RMS over triangles and keys, relative to the rest pose's diagonal
  double cost_share =
      0;  ///< of the expected work of a ray that hits the model's bounds; all sum to 1
};

/// One per cluster. The cost of a cluster is how often a ray that hits the model's bounds hits
/// the cluster's (by their surface areas in the world, mean over keys), times the cost of entering
/// it and of its fuzzy kd-trees (SAH, mean over keys): docs/method.md, cost. Residuals are taken at
/// keys spread evenly over the file, fewer of them where it has many vertices. Cost: O(keys *
/// clusters + tree nodes), and at most some ten million vertices.
std::vector<ClusterFacts> cluster_facts(const ModelView& model);

/// A model of which some clusters are left out. Triangles and clusters keep their
/// numbers: a triangle that is left out shrinks to its first corner, which no ray hits and every
/// box that held it still holds, and its cluster's world boxes shrink to a point, so that no ray
/// enters it. So every technique shows the part, unchanged, and a model shown whole costs nothing.
class PartialModel {
 public:
  /// `left_out`: one per cluster, not 0 where it is. The memory of `whole` must outlive this. Cost:
  /// O(triangles + keys * clusters).
  PartialModel(const ModelView& whole, std::span<const std::uint8_t> left_out);
  PartialModel(const PartialModel&) = delete;
  PartialModel& operator=(const PartialModel&) = delete;

  const ModelView& model() const { return model_; }

 private:
  ModelView model_;
  std::vector<Triangle> triangles_;
  std::vector<QuantizedBox> world_boxes_;
};

/// Which clusters of the open file are shown, and which one the pointer is on.
class ClusterView {
 public:
  ClusterView() = default;
  /// Of a model that outlives this; all are shown.
  explicit ClusterView(const ModelView& model)
      : model_(&model), hidden_(model.cluster_count(), 0) {}

  /// Whether the cluster itself was hidden, whatever solo says.
  bool hidden(std::uint32_t cluster) const { return hidden_[cluster] != 0; }
  /// Whether it is in the picture.
  bool shown(std::uint32_t cluster) const;
  std::optional<std::uint32_t> solo() const { return solo_; }
  std::uint32_t shown_count() const;

  void toggle_hidden(std::uint32_t cluster);
  /// Shows this one alone, or, where it is alone already, all as before.
  void toggle_solo(std::uint32_t cluster);
  void show_all();

  /// What is shown where that is not all; else null. The same object until it changes.
  const std::shared_ptr<const PartialModel>& part() const { return part_; }

  /// Computed when first asked for: see cluster_facts().
  const std::vector<ClusterFacts>& facts();

  std::optional<std::uint32_t> hovered;  ///< under the pointer in the list

 private:
  void update_part();

  const ModelView* model_ = nullptr;
  std::vector<std::uint8_t> hidden_;
  std::optional<std::uint32_t> solo_;
  std::shared_ptr<const PartialModel> part_;
  std::vector<ClusterFacts> facts_;
};

}  // namespace mdk
