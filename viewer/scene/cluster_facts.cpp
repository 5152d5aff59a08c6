#include "viewer/scene/cluster_facts.h"

#include <algorithm>
#include <cmath>

#include "common/motion/posed_mesh.h"
#include "common/structures/kd_tree_builder.h"
#include "common/trace/residuals.h"

namespace mdk {
namespace {

constexpr double kEnterCost = 3;  // of a cluster, in units of one triangle test
constexpr std::uint64_t kMostVertices = 8'000'000;
constexpr std::uint32_t kMostKeys = 24;

// Sums of squares, then the root of the mean.
void take_residuals(const Model& model, std::vector<ClusterFacts>& facts) {
  const std::uint64_t affordable = kMostVertices / std::max(1u, model.vertex_count);
  const auto keys = static_cast<std::uint32_t>(
      std::clamp<std::uint64_t>(affordable, 1, std::min(kMostKeys, model.key_count())));
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

double mean_world_area(const Model& model, std::uint32_t cluster) {
  double sum = 0;
  for (std::uint32_t key = 0; key < model.key_count(); ++key)
    sum += static_cast<double>(model.world_box(key, cluster).surface_area());
  return sum / model.key_count();
}

double mean_tree_cost(const Model& model, std::uint32_t cluster) {
  const KdBuildConfig config;
  double sum = 0, keys = 0;
  for (std::uint32_t s = 0; s < model.segment_count(); ++s) {
    const double weight = model.segments[s].last_key - model.segments[s].first_key + 1;
    sum += weight * sah_cost(model.tree_view(model.segment_trees(s)[cluster]), config);
    keys += weight;
  }
  return sum / keys;
}

}  // namespace

std::vector<ClusterFacts> cluster_facts(const Model& model) {
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

}  // namespace mdk
