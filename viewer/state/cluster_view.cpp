#include "viewer/state/cluster_view.h"

#include <algorithm>

namespace mdk {

bool ClusterView::shown(std::uint32_t cluster) const {
  return solo_ ? *solo_ == cluster : hidden_[cluster] == 0;
}

std::uint32_t ClusterView::shown_count() const {
  if (solo_) return 1;
  return static_cast<std::uint32_t>(std::count(hidden_.begin(), hidden_.end(), 0));
}

void ClusterView::toggle_hidden(std::uint32_t cluster) {
  hidden_[cluster] ^= 1;
  update_part();
}

void ClusterView::toggle_solo(std::uint32_t cluster) {
  solo_ = solo_ == cluster ? std::nullopt : std::optional(cluster);
  update_part();
}

void ClusterView::show_all() {
  solo_.reset();
  std::fill(hidden_.begin(), hidden_.end(), 0);
  update_part();
}

const std::vector<ClusterFacts>& ClusterView::facts() {
  if (facts_.empty() && model_) facts_ = cluster_facts(*model_);
  return facts_;
}

void ClusterView::update_part() {
  part_.reset();
  if (shown_count() == hidden_.size()) return;
  std::vector<std::uint8_t> left_out(hidden_.size());
  for (std::uint32_t c = 0; c < left_out.size(); ++c) left_out[c] = shown(c) ? 0 : 1;
  part_ = std::make_shared<const PartialModel>(*model_, left_out);
}

}  // namespace mdk
