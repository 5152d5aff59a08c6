// Where a further cluster helps most (GFW06 §3.1: the worst triangle and its neighbours), and the
// paper's restart of the old clusters from their best triangles.
#pragma once

#include <cstdint>
#include <vector>

#include "preprocess/clustering.h"

namespace mdk {

/// A cluster that does not exist yet.
struct ClusterOffer {
  std::vector<std::uint32_t> triangles;  ///< those it would take over
  double gain = 0;  ///< by how much that lowers the residual before any relaxation, table units
};

struct SeedOptions {
  std::uint32_t candidates = 8;     ///< worst triangles tried, each from another cluster first
  std::size_t patch_vertices = 12;  ///< a seed's neighbourhood grows to at least this many
  int refinements = 2;              ///< each: fit to the triangles won so far, look again
};

/// The best of several seeds: from the worst triangle of each cluster with much residual motion, a
/// patch is fitted, then refitted to the triangles it wins. No gain where all residuals are noise.
/// Cost: O(candidates * refinements * rows * vertices).
ClusterOffer best_new_cluster(const MovingMesh& mesh, const Clustering& clustering,
                              const SeedOptions& options = {});

/// `clustering` with the offer accepted: one cluster more.
Clustering accept_offer(const MovingMesh& mesh, const Clustering& clustering,
                        const ClusterOffer& offer);

/// Every cluster shrunk to its best triangle and neighbours, all triangles assigned anew to the
/// maps of those (GFW06 §3.1).
Clustering restart_from_prototypes(const MovingMesh& mesh, const Clustering& clustering,
                                   const SeedOptions& options = {});

/// The cluster with the most triangles cut in two halves at the median of its longest side in the
/// rest pose; at least one cluster must have two triangles. For when motion gives no reason to
/// split. Returns the assignment with one cluster more.
std::vector<std::uint32_t> halve_largest(const MovingMesh& mesh, std::uint32_t rest_row,
                                         std::vector<std::uint32_t> cluster_of_triangle);

}  // namespace mdk
