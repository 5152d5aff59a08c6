// Lloyd relaxation over triangles (GFW06 §3.1): fit a map per cluster and key, give each triangle
// to the cluster whose maps leave it the least residual motion, repeat.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/motion/pose_sequence.h"
#include "preprocess/cluster_fit.h"
#include "preprocess/mesh_neighbors.h"
#include "preprocess/pose_table.h"

namespace mdk {

/// What clustering looks at. Refers to its parts, which must outlive it.
struct MovingMesh {
  const PoseTable& poses;
  std::span<const Triangle> triangles;
  const VertexTriangles& neighbors;
};

/// K clusters, fitted. No cluster is empty.
struct Clustering {
  std::uint32_t rest_row = 0;
  std::uint32_t cluster_count = 0;
  std::vector<std::uint32_t> cluster_of_triangle;  ///< T
  ClusterMaps maps;                                ///< fitted to this assignment
  std::vector<float> vertex_residuals;             ///< K * V, cluster-major, of these maps
  double residual = 0;  ///< sum over triangles, corners and rows of squared residuals, table units

  std::span<const float> residuals_of(std::uint32_t cluster, std::uint32_t vertex_count) const {
    return std::span(vertex_residuals)
        .subspan(static_cast<std::size_t>(cluster) * vertex_count, vertex_count);
  }
};

struct LloydOptions {
  double min_gain = 0.01;  ///< a round that lowers the residual by a smaller share is the last
  int max_rounds = 24;
};

/// The residual below which a triangle's motion is float noise; ties within it change nothing.
double residual_noise(const PoseTable& table);

/// A triangle's residual under one cluster's `vertex_residuals`.
inline double triangle_residual(const Triangle& t, std::span<const float> vertex_residuals) {
  return static_cast<double>(vertex_residuals[t.v[0]]) + vertex_residuals[t.v[1]] +
         vertex_residuals[t.v[2]];
}

/// Renumbers the clusters in use to 0..K-1, keeping their order; returns K.
std::uint32_t drop_empty_clusters(std::vector<std::uint32_t>& cluster_of_triangle);

/// Fits maps to an assignment; clusters without triangles are dropped, the others keep their order.
Clustering fit_assignment(const MovingMesh& mesh, std::uint32_t rest_row,
                          std::vector<std::uint32_t> cluster_of_triangle);

/// Gives each triangle to the cluster with the least residual; ties stay where they are.
/// `vertex_residuals`: K * V, cluster-major. Returns how many triangles moved.
std::size_t reassign_triangles(const MovingMesh& mesh, std::span<const float> vertex_residuals,
                               std::span<std::uint32_t> cluster_of_triangle);

/// Lloyd rounds from a fitted clustering. The result's residual is never above the start's.
/// Cost per round: O(vertices * clusters * rows).
Clustering relax(const MovingMesh& mesh, Clustering start, const LloydOptions& options = {});

}  // namespace mdk
