#include "viewer/state/clusters.h"

#include <algorithm>
#include <cmath>

#include "common/motion/posed_mesh.h"
#include "common/structures/kd_tree.h"
#include "common/trace/heat_map.h"

namespace mdk {
namespace {

constexpr double kEnterCost = 3;  // of a cluster, in units of one triangle test
constexpr std::uint64_t kMaxVertices = 8'000'000;
constexpr std::uint32_t kMaxKeys = 24;

// Sums of squares, then the root of the mean.
void take_residuals(const ModelView& model, std::vector<ClusterFacts>& facts) {
  const std::uint64_t affordable = kMaxVertices / std::max(1u, model.vertex_count);
  const auto keys = static_cast<std::uint32_t>(
      std::clamp<std::uint64_t>(affordable, 1, std::min(kMaxKeys, model.key_count())));
  PosedMesh mesh(model);
  std::vector<float> residuals(model.triangle_count());
  for (std::uint32_t i = 0; i < keys; ++i) {
    const std::uint64_t key =
        keys > 1 ? static_cast<std::uint64_t>(i) * (model.key_count() - 1) / (keys - 1) : 0;
    mesh.set_time(at_key(static_cast<std::uint32_t>(key)));
    triangle_residuals(mesh, residuals);
    for (std::size_t c = 0; c < facts.size(); ++c)
      for (std::uint32_t t = 0; t < facts[c].triangles; ++t) {
        const double residual = residuals[model.clusters[c].first_triangle + t];
        facts[c].residual += residual * residual;
      }
  }
  for (ClusterFacts& f : facts)
    f.residual = f.triangles > 0 ? std::sqrt(f.residual / (double{1} * f.triangles * keys)) : 0;
}

double mean_world_area(const ModelView& model, std::uint32_t cluster) {
  double sum = 0;
  for (std::uint32_t key = 0; key < model.key_count(); ++key)
    sum += static_cast<double>(surface_area(model.world_box(key, cluster)));
  return sum / model.key_count();
}

double mean_tree_cost(const ModelView& model, std::uint32_t cluster) {
  double sum = 0, keys = 0;
  for (std::uint32_t s = 0; s < model.segment_count(); ++s) {
    const double weight = model.segments[s].last_key - model.segments[s].first_key + 1;
    sum += weight * sah_cost(model.tree_view(model.segment_trees(s)[cluster]), kTriangleTreeConfig);
    keys += weight;
  }
  return sum / keys;
}

}  // namespace

std::vector<ClusterFacts> cluster_facts(const ModelView& model) {
  std::vector<ClusterFacts> facts(model.cluster_count());
  double total = 0;
  for (std::uint32_t c = 0; c < facts.size(); ++c) {
    facts[c].triangles = model.clusters[c].triangle_count;
    facts[c].cost_share = mean_world_area(model, c) * (kEnterCost + mean_tree_cost(model, c));
    total += facts[c].cost_share;
  }
  for (ClusterFacts& f : facts) f.cost_share = total > 0 ? f.cost_share / total : 0;
  take_residuals(model, facts);
  return facts;
}

PartialModel::PartialModel(const ModelView& whole, std::span<const std::uint8_t> left_out)
    : model_(whole),
      triangles_(whole.triangles.begin(), whole.triangles.end()),
      world_boxes_(whole.cluster_world_boxes.begin(), whole.cluster_world_boxes.end()) {
  const std::uint32_t clusters = whole.cluster_count();
  for (std::uint32_t c = 0; c < clusters; ++c) {
    if (left_out[c] == 0) continue;
    const Cluster& cluster = whole.clusters[c];
    for (std::uint32_t t = 0; t < cluster.triangle_count; ++t) {
      Triangle& triangle = triangles_[cluster.first_triangle + t];
      triangle.v[1] = triangle.v[2] = triangle.v[0];
    }
    for (std::size_t box = c; box < world_boxes_.size(); box += clusters)
      world_boxes_[box].hi = world_boxes_[box].lo;
  }
  model_.triangles = triangles_;
  model_.cluster_world_boxes = world_boxes_;
}

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
