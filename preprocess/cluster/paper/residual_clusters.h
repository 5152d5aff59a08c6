// Clusters by residual motion (GFW06 §3.1): a map per cluster and key is fitted to the rest pose,
// each triangle goes to the cluster whose maps leave it the least residual, and so on in rounds. A
// further cluster starts at the worst triangle and its neighbours, and old ones may start again
// from their best ones.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/math/affine3.h"
#include "preprocess/cluster/common_moves.h"
#include "preprocess/options.h"
#include "preprocess/pose/pose_table.h"

namespace mdk {

/// A moving mesh that knows which triangles are neighbours: always those of its own.
class ConnectedMesh : public MovingMesh {
 public:
  /// Cost: O(triangles + vertices).
  explicit ConnectedMesh(const MovingMesh& mesh);

  /// `seed` and its neighbours (triangles that share a vertex), ring by ring, until the patch has
  /// 12 vertices or its part of the mesh ends.
  std::vector<std::uint32_t> patch(std::uint32_t seed) const;

 private:
  std::vector<std::uint32_t> begin_;  ///< vertices + 1
  std::vector<std::uint32_t> users_;  ///< the triangles that use each vertex, rising
};

/// K clusters, fitted. It follows from the mesh, the rest row and the assignment alone.
struct ResidualClustering : Assignment {
  std::uint32_t rest_row = 0;
  std::vector<Affine3d> maps;           ///< K * R, cluster-major: see fit_clusters
  std::vector<float> vertex_residuals;  ///< K * V, cluster-major, of these maps
  double residual = 0;  ///< sum over triangles, corners and rows of squared residuals, table units

  /// Root of the mean squared residual per triangle corner and row, table units.
  double rms(const MovingMesh& mesh) const;
};

/// Fits maps to an assignment; clusters without triangles are dropped, the others keep their order.
ResidualClustering fit_residuals(const MovingMesh& mesh, std::uint32_t rest_row,
                                 std::vector<std::uint32_t> cluster_of_triangle);

/// Lloyd rounds from a fitted clustering. Cost per round: O(vertices * clusters * rows).
ResidualClustering relax(const MovingMesh& mesh, ResidualClustering start,
                         const RelaxLimits& limits = {});

/// The best of several seeds: from the worst triangle of each cluster with much residual motion, a
/// patch is fitted, then refitted to the triangles it wins. No gain where all residuals are noise.
/// Cost: O(seeds * refinements * rows * vertices).
ClusterOffer best_new_cluster(const ConnectedMesh& mesh, const ResidualClustering& clustering);

/// `clustering` with the offer accepted: one cluster more.
ResidualClustering accept_offer(const MovingMesh& mesh, const ResidualClustering& clustering,
                                const ClusterOffer& offer);

/// Every cluster shrunk to its best triangle and neighbours, all triangles assigned anew to the
/// maps of those (GFW06 §3.1).
ResidualClustering restart_from_prototypes(const ConnectedMesh& mesh,
                                           const ResidualClustering& clustering);

/// Grows clusters on the rows of `mesh`, to `request.clusters` or until the next one would lower
/// the residual by less than `request.stop_percent`, at most to kMaxClusters. After each insertion
/// Lloyd runs twice, from the clusters as they are and from prototypes (GFW06 restarts always;
/// keeping wins about as often), and the lower residual stays. The rest pose, where it is not
/// requested, is the one of the rows that GFW06 (3) prefers, searched again whenever the number of
/// clusters has doubled. `on_step` is called after each step. There must be as many triangles as
/// clusters are requested.
Growth grow_by_residuals(const MovingMesh& mesh, const ClusterRequest& request,
                         const OnGrowthStep& on_step);

}  // namespace mdk
