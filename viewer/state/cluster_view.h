// ClusterView: which clusters of the open file are shown, and which one the hand is on.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "viewer/scene/cluster_facts.h"
#include "viewer/scene/partial_model.h"

namespace mdk {

class ClusterView {
 public:
  ClusterView() = default;
  /// Of a model that outlives this; all are shown.
  explicit ClusterView(const Model& model) : model_(&model), hidden_(model.cluster_count(), 0) {}

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

  const Model* model_ = nullptr;
  std::vector<std::uint8_t> hidden_;
  std::optional<std::uint32_t> solo_;
  std::shared_ptr<const PartialModel> part_;
  std::vector<ClusterFacts> facts_;
};

}  // namespace mdk
