// The maps of one cluster: fitted towards small boxes, put into a basis in which the boxes are
// small, refined.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/math/affine3.h"
#include "preprocess/boxes/cost.h"
#include "preprocess/decomposition.h"
#include "preprocess/maps/cluster_points.h"
#include "preprocess/pose/pose_table.h"

namespace mdk {

// box_fit.cpp

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

// local_frame.cpp

struct LocalFrames {
  std::vector<Affine3d> local_from_rest;  ///< K: rigid, in table coordinates
  std::vector<ClusterWork> clusters;      ///< K: the cost's view of the clusters in these bases
};

/// Chooses between the axes as they are and the principal axes of the fuzzy positions. `maps`: K *
/// R, cluster-major, row's pose to rest pose, in table coordinates. Cost: O(rows * vertices).
LocalFrames choose_local_frames(const PoseTable& table, const ClusterMembers& members,
                                std::span<const Affine3d> maps);

/// Fuzzy boxes of a cluster under some maps: summed mean area in units of the model's.
/// `maps`: R, from centred row coordinates; `model_areas`: R. Cost: O(rows * vertices).
double fuzzy_area(const ClusterPoints& points, std::span<const Affine3d> maps,
                  std::span<const double> model_areas);

/// The maps, followed by the rotation that makes the boxes smallest; as they are where none was
/// found. Searched on up to 32 rows, judged on all. Cost: O(32 * vertices), some fifty times.
std::vector<Affine3d> turned_to_small_boxes(const ClusterPoints& points,
                                            std::span<const Affine3d> maps,
                                            std::span<const double> model_areas);

// refinement.cpp

/// `maps`: R, from centred row coordinates into the local basis; `model_areas`: R. Returns maps
/// that lower the smooth cost; the caller must ask the true one. Cost: O(rows * vertices) an
/// iteration.
std::vector<Affine3d> refine_maps(const ClusterPoints& points, std::span<const Affine3d> maps,
                                  std::span<const double> model_areas);

}  // namespace mdk
