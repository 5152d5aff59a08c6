// Clusters by what counts when rays are traced: each triangle goes to the cluster in whose basis
// its fuzzy box is smallest, maps are fitted so that boxes shrink, and the cost decides
// (docs/method.md). A Lloyd relaxation like the paper's, but on boxes instead of residuals.
#pragma once

#include <cstdint>
#include <vector>

#include "preprocess/cluster_points.h"
#include "preprocess/clustering.h"
#include "preprocess/cost.h"

namespace mdk {

/// How boxes are measured.
struct BoxMeasure {
  std::uint32_t rest_row = 0;       ///< the row whose shape fits start from
  std::vector<double> model_areas;  ///< R: area of the model's box, table units
  CostOptions cost;
  double triangle_weight = 1;  ///< how many triangles each one stands for (a thinned mesh)
};

/// What box clustering looks at.
struct BoxProblem {
  MovingMesh mesh;
  BoxMeasure measure;
};

/// One cluster, fitted.
struct BoxCluster {
  std::vector<Affine3d> maps;     ///< R: local_from_row, table coordinates, local basis folded in
  std::vector<Aabb> world_boxes;  ///< R: of its vertices, table coordinates
  ClusterWork work;
  double residual = 0;  ///< sum over rows and corners of squared distances from the boxes' middles

  double cost(const CostOptions& options) const {
    return work.area() + work.hit_probability * options.transform_cost;
  }
};

/// K clusters, none empty.
struct BoxClustering {
  std::vector<std::uint32_t> cluster_of_triangle;  ///< T
  std::vector<BoxCluster> clusters;                ///< K
  double cost = 0;                                 ///< expected_work

  std::uint32_t cluster_count() const { return static_cast<std::uint32_t>(clusters.size()); }
};

/// Fits one cluster: least squares to its shape in the rest row, and to the middles of the boxes
/// that gives, each in the axes as they are and in the principal ones; what is cheapest stays.
/// Cost: O(rows * vertices).
BoxCluster fit_box_cluster(const BoxMeasure& measure, const ClusterPoints& points);

/// Fits all clusters of an assignment; empty ones are dropped. Runs in parallel.
BoxClustering fit_boxes(const BoxProblem& problem, std::vector<std::uint32_t> cluster_of_triangle);

/// Rounds of moving triangles to the cluster that costs least and fitting again, as long as the
/// cost falls by more than `min_gain` of itself, at most `max_rounds`.
BoxClustering relax_boxes(const BoxProblem& problem, BoxClustering start,
                          const LloydOptions& options);

}  // namespace mdk
