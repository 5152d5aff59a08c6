// One cluster's maps towards small boxes: least squares to a shape, and to the middles of the boxes
// that gives, so that no single pose decides (docs/method.md, fit).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "preprocess/maps/cluster_points.h"

namespace mdk {

/// Least-squares maps of all rows onto the targets.
struct PointFit {
  std::vector<Affine3d> maps;  ///< R, from centred row coordinates
  double scatter[3][3] = {};   ///< sum over rows and corners of (p - mean)(p - mean)^T, p mapped
};

/// Second moments of every row; fits to several targets share them. Cost: O(rows * vertices).
std::vector<SecondMoments> point_moments(const ClusterPoints& points,
                                         std::span<const float> weights);

/// `weights`: one per vertex, padded like ClusterPoints; at least one must be positive. `moments`:
/// of the points with these weights. Cost: O(rows * vertices).
PointFit fit_points(const ClusterPoints& points, std::span<const SecondMoments> moments,
                    const PointTargets& targets, std::span<const float> weights);
PointFit fit_points(const ClusterPoints& points, const PointTargets& targets,
                    std::span<const float> weights);

/// How boxes are measured.
struct BoxMeasure {
  std::uint32_t rest_row = 0;       ///< the row whose shape fits start from
  std::vector<double> model_areas;  ///< R: area of the model's box, table units
  double triangle_weight = 1;       ///< how many triangles each one stands for (a thinned mesh)
};

/// One cluster, fitted.
struct BoxCluster {
  std::vector<Affine3d> maps;     ///< R: local_from_row, table coordinates, local basis folded in
  std::vector<Aabb> world_boxes;  ///< R: of its vertices, table coordinates
  ClusterWork work;
  double residual = 0;  ///< sum over rows and corners of squared distances from the boxes' middles
};

/// Fits one cluster: least squares to its shape in the rest row, and to the middles of the boxes
/// that gives, each in the axes as they are and in the principal ones; what is cheapest stays.
/// Cost: O(rows * vertices).
BoxCluster fit_box_cluster(const BoxMeasure& measure, const ClusterPoints& points);

}  // namespace mdk
