#include "preprocess/cluster_seeds.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "common/math/aabb.h"

namespace mdk {
namespace {

/// Residual of every triangle in its own cluster.
std::vector<double> own_residuals(const MovingMesh& mesh, const Clustering& clustering) {
  std::vector<double> own(mesh.triangles.size());
  for (std::size_t t = 0; t < own.size(); ++t)
    own[t] = triangle_residual(
        mesh.triangles[t],
        clustering.residuals_of(clustering.cluster_of_triangle[t], mesh.poses.vertex_count));
  return own;
}

/// Seeds: round by round over the clusters in falling order of residual; first their worst
/// triangles, then ones of evenly falling rank (an outlier is a poor seed, a typical bad triangle
/// may be good).
std::vector<std::uint32_t> candidate_seeds(const Clustering& clustering,
                                           std::span<const double> own, std::uint32_t count) {
  std::vector<std::vector<std::uint32_t>> by_cluster(clustering.cluster_count);
  std::vector<double> sums(clustering.cluster_count, 0);
  for (std::uint32_t t = 0; t < own.size(); ++t) {
    by_cluster[clustering.cluster_of_triangle[t]].push_back(t);
    sums[clustering.cluster_of_triangle[t]] += own[t];
  }
  std::vector<std::uint32_t> order(clustering.cluster_count);
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return sums[a] > sums[b]; });
  if (order.size() > count) order.resize(count);
  for (const std::uint32_t c : order)
    std::stable_sort(by_cluster[c].begin(), by_cluster[c].end(),
                     [&](std::uint32_t a, std::uint32_t b) { return own[a] > own[b]; });

  std::vector<std::uint32_t> seeds;
  for (std::size_t round = 0; seeds.size() < count && round < count; ++round)
    for (const std::uint32_t c : order) {
      if (seeds.size() == count) break;
      const std::vector<std::uint32_t>& members = by_cluster[c];
      const std::uint32_t t = members[members.size() * round / count];
      if (std::find(seeds.begin(), seeds.end(), t) == seeds.end()) seeds.push_back(t);
    }
  return seeds;
}

/// The triangles that a cluster fitted to `chosen` would win.
ClusterOffer offer_from(const MovingMesh& mesh, std::uint32_t rest_row,
                        std::span<const std::uint32_t> chosen, std::span<const double> own) {
  const ClusterMaps maps = fit_triangles(mesh.poses, mesh.triangles, chosen, rest_row);
  std::vector<float> residuals(mesh.poses.vertex_count);
  vertex_residuals(mesh.poses, rest_row, maps.of(0), residuals);
  const double noise = residual_noise(mesh.poses);
  ClusterOffer offer;
  for (std::uint32_t t = 0; t < own.size(); ++t) {
    const double gain = own[t] - noise - triangle_residual(mesh.triangles[t], residuals);
    if (gain <= 0) continue;
    offer.triangles.push_back(t);
    offer.gain += gain;
  }
  return offer;
}

}  // namespace

ClusterOffer best_new_cluster(const MovingMesh& mesh, const Clustering& clustering,
                              const SeedOptions& options) {
  const std::vector<double> own = own_residuals(mesh, clustering);
  ClusterOffer best;
  for (const std::uint32_t seed : candidate_seeds(clustering, own, options.candidates)) {
    if (own[seed] <= residual_noise(mesh.poses)) continue;
    const std::vector<std::uint32_t> patch =
        grow_patch(mesh.triangles, mesh.neighbors, seed, options.patch_vertices);
    ClusterOffer offer = offer_from(mesh, clustering.rest_row, patch, own);
    for (int i = 0; i < options.refinements && !offer.triangles.empty(); ++i) {
      ClusterOffer refined = offer_from(mesh, clustering.rest_row, offer.triangles, own);
      if (refined.gain <= offer.gain) break;
      offer = std::move(refined);
    }
    if (offer.gain > best.gain) best = std::move(offer);
  }
  return best;
}

Clustering accept_offer(const MovingMesh& mesh, const Clustering& clustering,
                        const ClusterOffer& offer) {
  std::vector<std::uint32_t> assignment = clustering.cluster_of_triangle;
  for (const std::uint32_t t : offer.triangles) assignment[t] = clustering.cluster_count;
  return fit_assignment(mesh, clustering.rest_row, std::move(assignment));
}

Clustering restart_from_prototypes(const MovingMesh& mesh, const Clustering& clustering,
                                   const SeedOptions& options) {
  const std::vector<double> own = own_residuals(mesh, clustering);
  std::vector<std::uint32_t> prototype(clustering.cluster_count, 0);
  std::vector<double> least(clustering.cluster_count, std::numeric_limits<double>::infinity());
  for (std::uint32_t t = 0; t < own.size(); ++t) {
    const std::uint32_t c = clustering.cluster_of_triangle[t];
    if (own[t] < least[c]) {
      least[c] = own[t];
      prototype[c] = t;
    }
  }
  std::vector<Affine3d> maps;
  for (std::uint32_t c = 0; c < clustering.cluster_count; ++c) {
    const std::vector<std::uint32_t> patch =
        grow_patch(mesh.triangles, mesh.neighbors, prototype[c], options.patch_vertices);
    const ClusterMaps fit = fit_triangles(mesh.poses, mesh.triangles, patch, clustering.rest_row);
    maps.insert(maps.end(), fit.maps.begin(), fit.maps.end());
  }
  std::vector<float> residuals(clustering.vertex_residuals.size());
  vertex_residuals(mesh.poses, clustering.rest_row, maps, residuals);
  std::vector<std::uint32_t> assignment = clustering.cluster_of_triangle;
  reassign_triangles(mesh, residuals, assignment);
  return fit_assignment(mesh, clustering.rest_row, std::move(assignment));
}

std::vector<std::uint32_t> halve_largest(const MovingMesh& mesh, std::uint32_t rest_row,
                                         std::vector<std::uint32_t> cluster_of_triangle) {
  const std::uint32_t count =
      *std::max_element(cluster_of_triangle.begin(), cluster_of_triangle.end()) + 1;
  std::vector<std::size_t> sizes(count, 0);
  for (const std::uint32_t c : cluster_of_triangle) ++sizes[c];
  const auto largest =
      static_cast<std::uint32_t>(std::max_element(sizes.begin(), sizes.end()) - sizes.begin());

  const auto center = [&](std::uint32_t t) {
    Vec3d sum;
    for (const std::uint32_t v : mesh.triangles[t].v) sum += mesh.poses.position(rest_row, v);
    return sum;
  };
  std::vector<std::uint32_t> order;
  Aabbd box;
  for (std::uint32_t t = 0; t < cluster_of_triangle.size(); ++t)
    if (cluster_of_triangle[t] == largest) {
      order.push_back(t);
      box.extend(center(t));
    }
  const Vec3d e = box.extent();
  const std::size_t axis = e.x >= e.y && e.x >= e.z ? 0 : e.y >= e.z ? 1 : 2;
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return center(a)[axis] < center(b)[axis];
  });
  for (std::size_t i = order.size() / 2; i < order.size(); ++i)
    cluster_of_triangle[order[i]] = count;
  return cluster_of_triangle;
}

}  // namespace mdk
