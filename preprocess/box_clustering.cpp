#include "preprocess/box_clustering.h"

#include <Eigen/Dense>
#include <algorithm>
#include <utility>

#include "common/base/parallel.h"
#include "preprocess/box_alternatives.h"

namespace mdk {
namespace {

constexpr std::size_t kTrianglesPerChunk = 2048;
constexpr std::uint32_t kRowsForGrowth = 8;
constexpr int kFits = 2;  // to the rest pose, then to the middles of the boxes
/// A triangle moves only for more than this share of its area: less is float noise.
constexpr float kLeastShare = 1e-3f;

FaceSums face_sums(const ClusterPoints& points, const PointBoxes& boxes) {
  FaceSums sums;
  for (std::size_t t = 0; t < points.triangle_count(); ++t)
    sums.add(boxes.triangle(&points.corners[3 * t]));
  return sums;
}

/// Rows: the directions in which the mapped points scatter, as a proper rotation.
Affine3d principal_rotation(const double (&scatter)[3][3]) {
  Eigen::Matrix3d m;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) m(i, j) = scatter[i][j];
  Eigen::Matrix3d axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(m).eigenvectors();
  if (axes.determinant() < 0) axes.col(0) = -axes.col(0);
  Affine3d rotation;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) rotation.m[i][j] = axes(j, i);
  return rotation;
}

Aabb world_box(const ClusterPoints& points, std::uint32_t row) {
  const std::size_t at = points.row_offset(row);
  Aabb box;
  for (std::size_t i = at; i < at + points.vertex_count; ++i)
    box.extend(Vec3f{points.x[i], points.y[i], points.z[i]});
  const Vec3f center = to_float(points.centers[row]);
  return {box.lo + center, box.hi + center};
}

/// What a triangle would add to the price of entering a cluster: its world boxes grow.
double entry_growth(const BoxProblem& problem, const BoxCluster& cluster, const Triangle& t) {
  const PoseTable& table = problem.mesh.poses;
  const std::uint32_t step = (table.row_count() + kRowsForGrowth - 1) / kRowsForGrowth;
  double sum = 0, rows = 0;
  for (std::uint32_t row = 0; row < table.row_count(); row += step) {
    rows += 1;
    if (!(problem.measure.model_areas[row] > 0)) continue;
    const Aabb& box = cluster.world_boxes[row];
    Aabb grown = box;
    for (const std::uint32_t v : t.v) grown.extend(to_float(table.position(row, v)));
    sum += (grown.surface_area() - box.surface_area()) / problem.measure.model_areas[row];
  }
  return sum / rows * problem.measure.cost.transform_cost;
}

std::size_t move_triangles(const BoxProblem& problem, const BoxClustering& clustering,
                           const BoxAlternatives& alternatives,
                           std::vector<std::uint32_t>& assignment) {
  const std::span<const Triangle> triangles = problem.mesh.triangles;
  std::vector<std::size_t> moved((triangles.size() + kTrianglesPerChunk - 1) / kTrianglesPerChunk,
                                 0);
  parallel_chunks(triangles.size(), kTrianglesPerChunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      const double gain = alternatives.own_area[t] * (1 - kLeastShare) - alternatives.other_area[t];
      if (!(gain > 0)) continue;
      const std::uint32_t other = alternatives.other[t];
      if (entry_growth(problem, clustering.clusters[other], triangles[t]) >= gain) continue;
      assignment[t] = other;
      ++moved[begin / kTrianglesPerChunk];
    }
  });
  std::size_t sum = 0;
  for (const std::size_t m : moved) sum += m;
  return sum;
}

std::vector<Affine3d> rotated(const Affine3d& rotation, std::span<const Affine3d> maps) {
  std::vector<Affine3d> result;
  for (const Affine3d& map : maps) result.push_back(rotation * map);
  return result;
}

/// Gives the cluster these maps where they make its boxes smaller than the ones it has, if any.
void keep_cheaper(const BoxMeasure& measure, std::span<const Affine3d> maps, const FaceSums& faces,
                  BoxCluster& cluster) {
  ClusterWork work;
  work.fuzzy_boxes = faces * measure.triangle_weight;
  work.weights = mean_area_weights(maps, measure.model_areas, measure.cost);
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

double mean_hit_probability(std::span<const Aabb> world_boxes,
                            std::span<const double> model_areas) {
  double met = 0, rows = 0;
  for (std::size_t row = 0; row < world_boxes.size(); ++row) {
    if (!(model_areas[row] > 0)) continue;
    met += world_boxes[row].surface_area() / model_areas[row];
    rows += 1;
  }
  return rows > 0 ? met / rows : 1;
}

}  // namespace

BoxCluster fit_box_cluster(const BoxMeasure& measure, const ClusterPoints& points) {
  const std::vector<SecondMoments> moments = point_moments(points, points.weights);
  BoxCluster cluster;
  PointTargets targets = row_targets(points, measure.rest_row);
  for (int fit = 0; fit < kFits; ++fit) {
    const PointFit fitted = fit_points(points, moments, targets, points.weights);
    const PointBoxes boxes = mapped_boxes(points, fitted.maps);
    targets = boxes.centers();
    keep_cheaper(measure, fitted.maps, face_sums(points, boxes), cluster);
    const std::vector<Affine3d> turned = rotated(principal_rotation(fitted.scatter), fitted.maps);
    keep_cheaper(measure, turned, face_sums(points, mapped_boxes(points, turned)), cluster);
  }
  cluster.residual = residual_about_middles(points, cluster.maps);
  cluster.maps = from_table(points, cluster.maps);
  for (std::uint32_t row = 0; row < points.row_count; ++row)
    cluster.world_boxes.push_back(world_box(points, row));
  cluster.work.hit_probability = mean_hit_probability(cluster.world_boxes, measure.model_areas);
  return cluster;
}

BoxClustering fit_boxes(const BoxProblem& problem, std::vector<std::uint32_t> cluster_of_triangle) {
  BoxClustering result;
  const std::uint32_t count = drop_empty_clusters(cluster_of_triangle);
  result.cluster_of_triangle = std::move(cluster_of_triangle);
  result.clusters.resize(count);
  const ClusterMembers members = make_cluster_members(
      problem.mesh.triangles, result.cluster_of_triangle, count, problem.mesh.poses.vertex_count);
  parallel_chunks(count, 1, [&](std::size_t c, std::size_t) {
    result.clusters[c] = fit_box_cluster(
        problem.measure, gather_points(problem.mesh.poses, members, static_cast<std::uint32_t>(c)));
  });
  for (const BoxCluster& c : result.clusters) result.cost += c.cost(problem.measure.cost);
  return result;
}

BoxClustering relax_boxes(const BoxProblem& problem, BoxClustering start,
                          const LloydOptions& options) {
  BoxClustering best = std::move(start);
  for (int round = 0; round < options.max_rounds; ++round) {
    std::vector<std::uint32_t> assignment = best.cluster_of_triangle;
    if (move_triangles(problem, best, find_alternatives(problem, best), assignment) == 0) break;
    BoxClustering next = fit_boxes(problem, std::move(assignment));
    const double gain = best.cost - next.cost;
    if (gain <= 0) break;
    const bool last = gain < options.min_gain * best.cost;
    best = std::move(next);
    if (last) break;
  }
  return best;
}

}  // namespace mdk
