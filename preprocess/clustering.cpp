#include "preprocess/clustering.h"

#include <algorithm>
#include <utility>

#include "common/base/parallel.h"

namespace mdk {
namespace {

double total_residual(const MovingMesh& mesh, const Clustering& clustering) {
  double sum = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    sum += triangle_residual(
        mesh.triangles[t],
        clustering.residuals_of(clustering.cluster_of_triangle[t], mesh.poses.vertex_count));
  return sum;
}

}  // namespace

std::uint32_t drop_empty_clusters(std::vector<std::uint32_t>& cluster_of_triangle) {
  const auto largest = std::max_element(cluster_of_triangle.begin(), cluster_of_triangle.end());
  std::vector<std::uint32_t> number(largest == cluster_of_triangle.end() ? 0 : *largest + 1, 0);
  for (const std::uint32_t c : cluster_of_triangle) number[c] = 1;
  std::uint32_t count = 0;
  for (std::uint32_t& n : number) n = n != 0 ? count++ : 0;
  for (std::uint32_t& c : cluster_of_triangle) c = number[c];
  return count;
}

double residual_noise(const PoseTable& table) {
  constexpr double kLength = 1e-6;  // in table units: what float positions and sums leave behind
  return 3 * kLength * kLength * table.row_count();
}

Clustering fit_assignment(const MovingMesh& mesh, std::uint32_t rest_row,
                          std::vector<std::uint32_t> cluster_of_triangle) {
  Clustering result;
  result.rest_row = rest_row;
  result.cluster_of_triangle = std::move(cluster_of_triangle);
  result.cluster_count = drop_empty_clusters(result.cluster_of_triangle);
  const std::size_t vertex_count = mesh.poses.vertex_count;
  const ClusterMembers members = make_cluster_members(
      mesh.triangles, result.cluster_of_triangle, result.cluster_count, mesh.poses.vertex_count);
  result.maps = fit_clusters(mesh.poses, members, rest_row);
  result.vertex_residuals.resize(result.cluster_count * vertex_count);
  vertex_residuals(mesh.poses, rest_row, result.maps.maps, result.vertex_residuals);
  result.residual = total_residual(mesh, result);
  return result;
}

std::size_t reassign_triangles(const MovingMesh& mesh, std::span<const float> vertex_residuals,
                               std::span<std::uint32_t> cluster_of_triangle) {
  constexpr std::size_t kChunk = 2048;
  const std::size_t vertex_count = mesh.poses.vertex_count;
  const std::size_t clusters = vertex_residuals.size() / vertex_count;
  const double noise = residual_noise(mesh.poses);
  std::vector<std::size_t> moved((mesh.triangles.size() + kChunk - 1) / kChunk, 0);
  parallel_chunks(mesh.triangles.size(), kChunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      const Triangle& triangle = mesh.triangles[t];
      const auto residual_in = [&](std::size_t c) {
        return triangle_residual(triangle,
                                 vertex_residuals.subspan(c * vertex_count, vertex_count));
      };
      const std::uint32_t home = cluster_of_triangle[t];
      std::uint32_t best = home;
      double least = residual_in(home) - noise;
      for (std::uint32_t c = 0; c < clusters; ++c) {
        const double r = c == home ? least : residual_in(c);
        if (r < least) {
          least = r;
          best = c;
        }
      }
      moved[begin / kChunk] += best != home;
      cluster_of_triangle[t] = best;
    }
  });
  std::size_t sum = 0;
  for (const std::size_t m : moved) sum += m;
  return sum;
}

Clustering relax(const MovingMesh& mesh, Clustering start, const LloydOptions& options) {
  Clustering best = std::move(start);
  for (int round = 0; round < options.max_rounds; ++round) {
    std::vector<std::uint32_t> assignment = best.cluster_of_triangle;
    if (reassign_triangles(mesh, best.vertex_residuals, assignment) == 0) break;
    Clustering next = fit_assignment(mesh, best.rest_row, std::move(assignment));
    const double gain = best.residual - next.residual;
    if (gain <= 0) break;
    const bool last = gain < options.min_gain * best.residual;
    best = std::move(next);
    if (last) break;
  }
  return best;
}

}  // namespace mdk
