// Maps of all clusters in all rows, fitted to the rest pose, and how well each vertex obeys them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/math/affine3.h"
#include "preprocess/affine_fit.h"
#include "preprocess/cluster_members.h"
#include "preprocess/pose_table.h"

namespace mdk {

/// K clusters, R rows. Maps go from a row's pose to the rest pose, both in table coordinates.
struct ClusterMaps {
  std::uint32_t row_count = 0;
  std::vector<Affine3d> maps;     ///< K * R, cluster-major
  std::vector<double> residuals;  ///< K * R: sum over corners of squared residuals, table units

  std::span<const Affine3d> of(std::uint32_t cluster) const {
    return std::span(maps).subspan(static_cast<std::size_t>(cluster) * row_count, row_count);
  }
};

/// The fit's options in table units, where float positions are good to 2^-24 or so.
FitOptions table_fit_options();

/// Least-squares maps of every cluster; corners weigh alike. Cost: O(rows * vertices).
ClusterMaps fit_clusters(const PoseTable& table, const ClusterMembers& members,
                         std::uint32_t rest_row);

/// Maps fitted to some triangles only (one cluster).
ClusterMaps fit_triangles(const PoseTable& table, std::span<const Triangle> triangles,
                          std::span<const std::uint32_t> chosen, std::uint32_t rest_row);

/// For every cluster and vertex, the sum over rows of |map(v) - r|^2, in table units. `maps`: K *
/// R, cluster-major; `out`: K * V, cluster-major. The dense kernel of clustering: O(K * R * V),
/// vectorised.
void vertex_residuals(const PoseTable& table, std::uint32_t rest_row,
                      std::span<const Affine3d> maps, std::span<float> out);

}  // namespace mdk
