// One cluster's maps towards small boxes: least squares to a shape, and to the middles of the boxes
// that gives, so that no single pose decides (docs/method.md, fit).
#include <algorithm>
#include <utility>

#include "preprocess/maps/affine_fit.h"
#include "preprocess/maps/cluster_maps.h"

namespace mdk {
namespace {

constexpr int kFits = 2;  // to the rest pose, then to the middles of the boxes

/// Maps of one cluster must not tumble from key to key in the directions in which it is thin, where
/// only noise speaks: boxes hold between keys, too. So such directions follow the rigid motion.
constexpr FitOptions kPointFit{.noise = 1e-7, .ridge = 1, .keep_orientation = true};

/// What all rows share when they are fitted to the same targets.
struct TargetSums {
  double weight = 0, first[3] = {}, trace = 0;
};

TargetSums target_sums(const PointTargets& targets, std::span<const float> weights) {
  TargetSums sums;
  for (const float w : weights) sums.weight += static_cast<double>(w);
  const SecondMoments m = second_moments(targets.from(0), weights.data(), weights.size());
  for (int i = 0; i < 3; ++i) {
    sums.first[i] = m.first[i];
    sums.trace += m.second[i][i] - m.first[i] * m.first[i] / sums.weight;
  }
  sums.trace = std::max(sums.trace, 0.0);
  return sums;
}

FitMoments row_moments(const SecondMoments& source, const double (&cross)[3][3],
                       const TargetSums& target) {
  FitMoments m;
  m.weight = target.weight;
  m.target_trace = target.trace;
  for (std::size_t i = 0; i < 3; ++i) {
    m.source_mean[i] = source.first[i] / m.weight;
    m.target_mean[i] = target.first[i] / m.weight;
    for (std::size_t j = 0; j < 3; ++j) {
      m.source[i][j] = source.second[i][j] - source.first[i] * source.first[j] / m.weight;
      m.cross[i][j] = cross[i][j] - target.first[i] * source.first[j] / m.weight;
    }
  }
  return m;
}

Aabb world_box(const ClusterPoints& points, std::uint32_t row) {
  const std::size_t at = points.row_offset(row);
  Aabb box;
  for (std::size_t i = at; i < at + points.vertex_count; ++i)
    box.extend(Vec3f{points.x[i], points.y[i], points.z[i]});
  const Vec3f center = to_float(points.centers[row]);
  return {box.lo + center, box.hi + center};
}

/// Gives the cluster these maps where they make its boxes smaller than the ones it has, if any.
void keep_cheaper(const BoxMeasure& measure, std::span<const Affine3d> maps, const FaceSums& faces,
                  BoxCluster& cluster) {
  ClusterWork work;
  work.fuzzy_boxes = faces * measure.triangle_weight;
  work.weights = mean_area_weights(maps, measure.model_areas);
  if (!cluster.maps.empty() && !(work.area() < cluster.work.area())) return;
  cluster.maps.assign(maps.begin(), maps.end());
  cluster.work = work;
}

double residual_about_middles(const ClusterPoints& points, std::span<const Affine3d> maps) {
  const PointTargets middles = mapped_boxes(points, maps).centers();
  const std::vector<float> residuals = point_residuals(points, maps, middles);
  double sum = 0;
  for (std::size_t i = 0; i < points.vertex_count; ++i)
    sum += static_cast<double>(points.weights[i]) * residuals[i];
  return sum;
}

}  // namespace

std::vector<SecondMoments> point_moments(const ClusterPoints& points,
                                         std::span<const float> weights) {
  std::vector<SecondMoments> moments;
  moments.reserve(points.row_count);
  for (std::uint32_t row = 0; row < points.row_count; ++row)
    moments.push_back(second_moments(points.row(row), weights.data(), points.stride));
  return moments;
}

PointFit fit_points(const ClusterPoints& points, const PointTargets& targets,
                    std::span<const float> weights) {
  return fit_points(points, point_moments(points, weights), targets, weights);
}

PointFit fit_points(const ClusterPoints& points, std::span<const SecondMoments> moments,
                    const PointTargets& targets, std::span<const float> weights) {
  PointFit fit;
  fit.maps.resize(points.row_count);
  const TargetSums target = target_sums(targets, weights);
  Vec3d sum;
  double weight = 0, square[3][3] = {};
  for (std::uint32_t row = 0; row < points.row_count; ++row) {
    double cross[3][3];
    cross_moments(points.row(row), targets.from(0), weights.data(), points.stride, cross);
    const FitMoments m = row_moments(moments[row], cross, target);
    const Affine3d map = fit_affine(m, kPointFit).target_from_source;
    fit.maps[row] = map;
    const Vec3d mean = map.point(m.source_mean);
    sum += mean * m.weight;
    weight += m.weight;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) {
        square[i][j] += m.weight * mean[i] * mean[j];
        for (std::size_t k = 0; k < 3; ++k)
          for (std::size_t l = 0; l < 3; ++l)
            square[i][j] += map.m[i][k] * m.source[k][l] * map.m[j][l];
      }
  }
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) fit.scatter[i][j] = square[i][j] - sum[i] * sum[j] / weight;
  return fit;
}

BoxCluster fit_box_cluster(const BoxMeasure& measure, const ClusterPoints& points) {
  const std::vector<SecondMoments> moments = point_moments(points, points.weights);
  BoxCluster cluster;
  PointTargets targets = row_targets(points, measure.rest_row);
  for (int fit = 0; fit < kFits; ++fit) {
    const PointFit fitted = fit_points(points, moments, targets, points.weights);
    const PointBoxes boxes = mapped_boxes(points, fitted.maps);
    targets = boxes.centers();
    keep_cheaper(measure, fitted.maps, face_sums(points, boxes), cluster);
    const std::vector<Affine3d> turned =
        followed_by(principal_rotation(fitted.scatter), fitted.maps);
    keep_cheaper(measure, turned, face_sums(points, mapped_boxes(points, turned)), cluster);
  }
  cluster.residual = residual_about_middles(points, cluster.maps);
  cluster.maps = from_table(points, cluster.maps);
  for (std::uint32_t row = 0; row < points.row_count; ++row)
    cluster.world_boxes.push_back(world_box(points, row));
  cluster.work.hit_probability =
      mean_hit_probability<float>(cluster.world_boxes, measure.model_areas);
  return cluster;
}

}  // namespace mdk
