#include "preprocess/cluster/paper/residual_clusters.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <unordered_set>
#include <utility>

#include "common/base/parallel.h"
#include "preprocess/maps/affine_fit.h"

namespace mdk {
namespace {

constexpr std::uint32_t kSeeds = 8;  // worst triangles tried, each from another cluster first
constexpr std::size_t kPatchVertices = 12;  // a seed's neighbourhood grows to at least this many
constexpr int kSeedRefinements = 2;         // each: fit to the triangles won so far, look again

/// The residual below which a triangle's motion is float noise; ties within it change nothing.
double residual_noise(const PoseTable& table) {
  constexpr double kLength = 1e-6;  // in table units: what float positions and sums leave behind
  return 3 * kLength * kLength * table.row_count();
}

/// A triangle's residual in a cluster. `vertex_residuals`: K * V.
double triangle_residual(const MovingMesh& mesh, std::span<const float> vertex_residuals,
                         std::size_t cluster, const Triangle& t) {
  const float* of_vertex = vertex_residuals.data() + cluster * mesh.poses.vertex_count;
  return static_cast<double>(of_vertex[t.v[0]]) + of_vertex[t.v[1]] + of_vertex[t.v[2]];
}

/// Gives each triangle to the cluster with the least residual; ties stay where they are.
std::vector<std::uint32_t> reassigned(const MovingMesh& mesh,
                                      std::span<const float> vertex_residuals,
                                      const Assignment& assignment) {
  constexpr std::size_t kChunk = 2048;
  const double noise = residual_noise(mesh.poses);
  std::vector<std::uint32_t> result(mesh.triangles.size());
  parallel_chunks(mesh.triangles.size(), kChunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      const auto residual_in = [&](std::size_t c) {
        return triangle_residual(mesh, vertex_residuals, c, mesh.triangles[t]);
      };
      const std::uint32_t home = assignment.cluster_of_triangle[t];
      std::uint32_t best = home;
      double least = residual_in(home) - noise;
      for (std::uint32_t c = 0; c < assignment.cluster_count; ++c) {
        const double r = c == home ? least : residual_in(c);
        if (r < least) {
          least = r;
          best = c;
        }
      }
      result[t] = best;
    }
  });
  return result;
}

/// Residual of every triangle in its own cluster.
std::vector<double> own_residuals(const MovingMesh& mesh, const ResidualClustering& clustering) {
  std::vector<double> own(mesh.triangles.size());
  for (std::size_t t = 0; t < own.size(); ++t)
    own[t] = triangle_residual(mesh, clustering.vertex_residuals, clustering.cluster_of_triangle[t],
                               mesh.triangles[t]);
  return own;
}

/// Seeds: round by round over the clusters in falling order of residual; first their worst
/// triangles, then ones of evenly falling rank (an outlier is a poor seed, a typical bad triangle
/// may be good).
std::vector<std::uint32_t> candidate_seeds(const ResidualClustering& clustering,
                                           std::span<const double> own) {
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
  if (order.size() > kSeeds) order.resize(kSeeds);
  for (const std::uint32_t c : order)
    std::stable_sort(by_cluster[c].begin(), by_cluster[c].end(),
                     [&](std::uint32_t a, std::uint32_t b) { return own[a] > own[b]; });

  std::vector<std::uint32_t> seeds;
  for (std::size_t round = 0; seeds.size() < kSeeds && round < kSeeds; ++round)
    for (const std::uint32_t c : order) {
      if (seeds.size() == kSeeds) break;
      const std::vector<std::uint32_t>& members = by_cluster[c];
      const std::uint32_t t = members[members.size() * round / kSeeds];
      if (std::find(seeds.begin(), seeds.end(), t) == seeds.end()) seeds.push_back(t);
    }
  return seeds;
}

/// The triangles that a cluster fitted to `chosen` would win.
ClusterOffer offer_from(const MovingMesh& mesh, std::uint32_t rest_row,
                        std::span<const std::uint32_t> chosen, std::span<const double> own) {
  const std::vector<float> residuals =
      vertex_residuals(mesh.poses, rest_row, fit_triangles(mesh, chosen, rest_row));
  const double noise = residual_noise(mesh.poses);
  ClusterOffer offer;
  for (std::uint32_t t = 0; t < own.size(); ++t) {
    const double gain = own[t] - noise - triangle_residual(mesh, residuals, 0, mesh.triangles[t]);
    if (gain <= 0) continue;
    offer.triangles.push_back(t);
    offer.gain += gain;
  }
  return offer;
}

}  // namespace

ConnectedMesh::ConnectedMesh(const MovingMesh& mesh) : MovingMesh(mesh) {
  begin_.assign(std::size_t{poses.vertex_count} + 1, 0);
  for (const Triangle& t : triangles)
    for (const std::uint32_t v : t.v) ++begin_[v + 1];
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  users_.resize(3 * triangles.size());
  std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    for (const std::uint32_t v : triangles[t].v) users_[next[v]++] = t;
}

std::vector<std::uint32_t> ConnectedMesh::patch(std::uint32_t seed) const {
  std::vector<std::uint32_t> patch{seed}, vertices;
  std::unordered_set<std::uint32_t> in_patch{seed}, seen;
  const auto add_vertices = [&](std::uint32_t triangle) {
    for (const std::uint32_t v : triangles[triangle].v)
      if (seen.insert(v).second) vertices.push_back(v);
  };
  add_vertices(seed);
  for (std::size_t ring_begin = 0;
       ring_begin < vertices.size() && vertices.size() < kPatchVertices;) {
    const std::size_t ring_end = vertices.size();
    for (std::size_t i = ring_begin; i < ring_end; ++i)
      for (std::uint32_t u = begin_[vertices[i]]; u < begin_[vertices[i] + 1]; ++u)
        if (in_patch.insert(users_[u]).second) {
          patch.push_back(users_[u]);
          add_vertices(users_[u]);
        }
    ring_begin = ring_end;
  }
  return patch;
}

double ResidualClustering::rms(const MovingMesh& mesh) const {
  const double terms = 3.0 * static_cast<double>(mesh.triangles.size()) * mesh.poses.row_count();
  return std::sqrt(residual / terms);
}

ResidualClustering fit_residuals(const MovingMesh& mesh, std::uint32_t rest_row,
                                 std::vector<std::uint32_t> cluster_of_triangle) {
  ResidualClustering result{make_assignment(std::move(cluster_of_triangle)), rest_row, {}, {}, 0};
  result.maps = fit_clusters(mesh.poses, mesh.members_of(result), rest_row);
  result.vertex_residuals = vertex_residuals(mesh.poses, rest_row, result.maps);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    result.residual += triangle_residual(mesh, result.vertex_residuals,
                                         result.cluster_of_triangle[t], mesh.triangles[t]);
  return result;
}

ResidualClustering relax(const MovingMesh& mesh, ResidualClustering start,
                         const RelaxLimits& limits) {
  const std::uint32_t rest_row = start.rest_row;
  return relax_rounds(
      std::move(start), limits, &ResidualClustering::residual,
      [&](const ResidualClustering& c) { return reassigned(mesh, c.vertex_residuals, c); },
      [&](std::vector<std::uint32_t> assignment) {
        return fit_residuals(mesh, rest_row, std::move(assignment));
      });
}

ClusterOffer best_new_cluster(const ConnectedMesh& mesh, const ResidualClustering& clustering) {
  const std::vector<double> own = own_residuals(mesh, clustering);
  ClusterOffer best;
  for (const std::uint32_t seed : candidate_seeds(clustering, own)) {
    if (own[seed] <= residual_noise(mesh.poses)) continue;
    ClusterOffer offer = offer_from(mesh, clustering.rest_row, mesh.patch(seed), own);
    for (int i = 0; i < kSeedRefinements && !offer.triangles.empty(); ++i) {
      ClusterOffer refined = offer_from(mesh, clustering.rest_row, offer.triangles, own);
      if (refined.gain <= offer.gain) break;
      offer = std::move(refined);
    }
    if (offer.gain > best.gain) best = std::move(offer);
  }
  return best;
}

ResidualClustering accept_offer(const MovingMesh& mesh, const ResidualClustering& clustering,
                                const ClusterOffer& offer) {
  std::vector<std::uint32_t> assignment = clustering.cluster_of_triangle;
  for (const std::uint32_t t : offer.triangles) assignment[t] = clustering.cluster_count;
  return fit_residuals(mesh, clustering.rest_row, std::move(assignment));
}

ResidualClustering restart_from_prototypes(const ConnectedMesh& mesh,
                                           const ResidualClustering& clustering) {
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
  for (const std::uint32_t t : prototype) {
    const std::vector<Affine3d> fit = fit_triangles(mesh, mesh.patch(t), clustering.rest_row);
    maps.insert(maps.end(), fit.begin(), fit.end());
  }
  return fit_residuals(
      mesh, clustering.rest_row,
      reassigned(mesh, vertex_residuals(mesh.poses, clustering.rest_row, maps), clustering));
}

}  // namespace mdk
