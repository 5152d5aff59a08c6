// Clusters by what counts when rays are traced: each triangle goes to the cluster in whose basis
// its fuzzy box is smallest, maps are fitted so that boxes shrink, and the cost decides
// (docs/method.md). Lloyd rounds like the paper's, but on boxes instead of residuals, and moves
// that such rounds cannot make: cutting a cluster in two, dissolving one into the others.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "preprocess/cluster/common_moves.h"
#include "preprocess/maps/cluster_maps.h"
#include "preprocess/pose/pose_table.h"

namespace mdk {

struct TriangleBlocks;

/// What box clustering looks at. Not for use from several threads at once.
struct BoxProblem {
  MovingMesh mesh;
  BoxMeasure measure;
  /// The mesh as find_alternatives() takes it, once it was asked.
  mutable std::shared_ptr<const TriangleBlocks> blocks = nullptr;
};

/// K clusters, fitted. It follows from the problem and the assignment alone.
struct BoxClustering : Assignment {
  std::vector<BoxCluster> clusters;  ///< K
  double cost = 0;                   ///< expected_work
};

/// Fits all clusters of an assignment; empty ones are dropped. Runs in parallel.
BoxClustering fit_boxes(const BoxProblem& problem, std::vector<std::uint32_t> cluster_of_triangle);

/// Lloyd rounds, in which triangles go to the cluster that costs least.
BoxClustering relax_boxes(const BoxProblem& problem, BoxClustering start,
                          const RelaxLimits& limits);

/// Where each triangle would have the smallest fuzzy box: the question behind every move, and most
/// of the work.
struct BoxAlternatives {
  std::vector<float> own_area;       ///< T: of the fuzzy box in its own cluster
  std::vector<float> other_area;     ///< T: in the best other cluster; infinite if there is none
  std::vector<std::uint32_t> other;  ///< T
};

/// A cluster number out of range in `clustering` makes the triangle's own area zero. Cost: at most
/// O(K * rows * vertices), vectorised, in parallel.
BoxAlternatives find_alternatives(const BoxProblem& problem, const BoxClustering& clustering);

/// Gives every triangle to the cluster in which its box is smallest.
std::vector<std::uint32_t> assign_to_smallest_boxes(const BoxProblem& problem,
                                                    std::vector<BoxCluster> clusters);

/// The best cut of every cluster in two, as an offer of the part that leaves, by a few rounds of
/// two-means from several seeds. Motion decides, not connectivity: a seed's patch is the triangles
/// that stay nearest to it in all poses. Cost: O(rows * vertices), times seeds and rounds; in
/// parallel.
std::vector<ClusterOffer> find_splits(const BoxProblem& problem, const BoxClustering& clustering);

/// `clustering` with the `count` best cuts made (fewer where there are none), fitted, not relaxed.
/// Only cuts that gain more than `min_gain`.
BoxClustering make_splits(const BoxProblem& problem, const BoxClustering& clustering,
                          const std::vector<ClusterOffer>& splits, std::uint32_t count,
                          double min_gain);

/// Dissolves clusters whose triangles would cost less elsewhere, as long as the cost falls.
BoxClustering dissolve_clusters(const BoxProblem& problem, BoxClustering clustering);

/// Dissolves up to `count` clusters that lose least by it and cuts as many others in two that gain
/// most, where both together gain; fitted, not relaxed. What Lloyd rounds cannot do: take a cluster
/// from where it is hardly needed to where it is missed. There may be fewer clusters afterwards.
BoxClustering exchange_clusters(const BoxProblem& problem, const BoxClustering& clustering,
                                std::uint32_t count);

// rigid_parts.cpp

/// Triangles of the connected parts that one map per row holds still, all parts that the same maps
/// hold still together. Cost: O(rows * vertices).
std::vector<std::vector<std::uint32_t>> find_rigid_parts(const MovingMesh& mesh);

/// Each part that several clusters share moved into the one of them in which its boxes are
/// smallest, fitted again.
BoxClustering with_whole_parts(const BoxProblem& problem, BoxClustering clustering,
                               std::span<const std::vector<std::uint32_t>> parts);

}  // namespace mdk
