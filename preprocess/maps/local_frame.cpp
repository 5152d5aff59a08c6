// Local bases: a rotation per cluster that makes its triangles' fuzzy boxes small (GFW06 §3.4). Any
// rotation can be folded into the maps; PCA of the fuzzy positions proposes, the summed world area
// of the fuzzy boxes decides. The origin is the middle of the cluster, where numbers are small. A
// finished cluster gets a better basis than its principal axes by a pattern search over rotations.
#include <Eigen/Dense>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "common/base/parallel.h"
#include "preprocess/maps/affine_fit.h"
#include "preprocess/maps/cluster_maps.h"

namespace mdk {
namespace {

using Matrix = Eigen::Matrix3d;

/// Everything about one cluster that its basis is chosen from.
struct ClusterFacts {
  const PoseTable& table;
  const ClusterMembers& members;
  std::uint32_t cluster;
  std::span<const Affine3d> maps;
  std::span<const double> model_areas;

  std::span<const std::uint32_t> vertices() const { return members.vertices_of(cluster); }
};

/// p -> rotation (p - origin)
Affine3d rigid_map(const Affine3d& rotation, const Eigen::Vector3d& origin) {
  Matrix linear;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) linear(i, j) = rotation.m[i][j];
  const Eigen::Vector3d shift = -(linear * origin);
  Affine3d a = rotation;
  for (int i = 0; i < 3; ++i) a.m[i][3] = shift(i);
  return a;
}

/// Mean and principal axes of the fuzzy positions.
struct PrincipalAxes {
  Eigen::Vector3d mean;
  Affine3d rotation;
};

PrincipalAxes principal_axes(const ClusterFacts& facts) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Matrix square = Matrix::Zero();
  double count = 0;
  for (std::uint32_t row = 0; row < facts.table.row_count(); ++row)
    for (const std::uint32_t v : facts.vertices()) {
      const Vec3d p = facts.maps[row].point(facts.table.position(row, v));
      const Eigen::Vector3d q(p.x, p.y, p.z);
      sum += q;
      square += q * q.transpose();
      count += 1;
    }
  const Matrix covariance = square - sum * sum.transpose() / count;
  double scatter[3][3];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) scatter[i][j] = covariance(i, j);
  return {sum / count, principal_rotation(scatter)};
}

/// Boxes of the triangles in a basis, summed.
FaceSums fuzzy_faces(const ClusterFacts& facts, std::span<const Affine3d> local_from_row) {
  const std::span<const std::uint32_t> vertices = facts.vertices();
  std::vector<Aabbd> boxes(vertices.size());
  for (std::uint32_t row = 0; row < facts.table.row_count(); ++row)
    for (std::size_t i = 0; i < vertices.size(); ++i)
      boxes[i].extend(local_from_row[row].point(facts.table.position(row, vertices[i])));
  FaceSums sums;
  const std::uint32_t first_slot = facts.members.vertex_begin[facts.cluster];
  const std::span<const std::uint32_t> slots = facts.members.corner_slots_of(facts.cluster);
  for (std::size_t i = 0; i < slots.size(); i += 3) {
    Aabbd box;
    for (const std::uint32_t slot : slots.subspan(i, 3)) box.extend(boxes[slot - first_slot]);
    sums.add(box);
  }
  return sums;
}

ClusterWork work_in_basis(const ClusterFacts& facts, const Affine3d& local_from_rest) {
  const std::vector<Affine3d> local_from_row = followed_by(local_from_rest, facts.maps);
  ClusterWork work;
  work.fuzzy_boxes = fuzzy_faces(facts, local_from_row);
  work.weights = mean_area_weights(local_from_row, facts.model_areas);
  return work;
}

/// The cluster's box in each row.
std::vector<Aabbd> row_boxes(const ClusterFacts& facts) {
  std::vector<Aabbd> boxes(facts.table.row_count());
  for (std::uint32_t row = 0; row < facts.table.row_count(); ++row)
    for (const std::uint32_t v : facts.vertices()) boxes[row].extend(facts.table.position(row, v));
  return boxes;
}

constexpr std::uint32_t kSearchRows = 32;
// Tangents of half the angles that are tried: 53 degrees, halved again and again down to 2.
constexpr double kFirstStep = 0.5, kLastStep = 0.015;

/// About one axis, by 2 atan(t): rational in t, so the same on every machine.
Affine3d turn_about(int axis, double t) {
  const int j = (axis + 1) % 3, k = (axis + 2) % 3;
  const double cosine = (1 - t * t) / (1 + t * t), sine = 2 * t / (1 + t * t);
  Affine3d turn;
  turn.m[j][j] = turn.m[k][k] = cosine;
  turn.m[j][k] = -sine;
  turn.m[k][j] = sine;
  return turn;
}

/// A cluster in some of its rows.
struct SearchSample {
  ClusterPoints points;
  std::vector<Affine3d> maps;
  std::vector<double> model_areas;
};

SearchSample make_sample(const ClusterPoints& points, std::span<const Affine3d> maps,
                         std::span<const double> model_areas) {
  SearchSample sample;
  std::vector<std::uint32_t> rows;
  const std::uint32_t step = (points.row_count + kSearchRows - 1) / kSearchRows;
  for (std::uint32_t row = 0; row < points.row_count; row += step) {
    rows.push_back(row);
    sample.maps.push_back(maps[row]);
    sample.model_areas.push_back(model_areas[row]);
  }
  sample.points = gather_rows(points, rows);
  return sample;
}

}  // namespace

LocalFrames choose_local_frames(const PoseTable& table, const ClusterMembers& members,
                                std::span<const Affine3d> maps) {
  const std::uint32_t clusters = members.cluster_count();
  const std::vector<double> areas = row_box_areas(table);
  LocalFrames result;
  result.local_from_rest.resize(clusters);
  result.clusters.resize(clusters);
  parallel_chunks(clusters, 1, [&](std::size_t begin, std::size_t) {
    const ClusterFacts facts{table, members, static_cast<std::uint32_t>(begin),
                             maps.subspan(begin * table.row_count(), table.row_count()), areas};
    const PrincipalAxes principal = principal_axes(facts);
    const Affine3d plain = rigid_map({}, principal.mean);
    const Affine3d turned = rigid_map(principal.rotation, principal.mean);
    const ClusterWork plain_work = work_in_basis(facts, plain);
    const ClusterWork turned_work = work_in_basis(facts, turned);
    const bool turn = turned_work.area() < plain_work.area();
    result.local_from_rest[begin] = turn ? turned : plain;
    result.clusters[begin] = turn ? turned_work : plain_work;
    result.clusters[begin].hit_probability = mean_hit_probability<double>(row_boxes(facts), areas);
  });
  return result;
}

double fuzzy_area(const ClusterPoints& points, std::span<const Affine3d> maps,
                  std::span<const double> model_areas) {
  return face_sums(points, mapped_boxes(points, maps)).area(mean_area_weights(maps, model_areas));
}

std::vector<Affine3d> turned_to_small_boxes(const ClusterPoints& points,
                                            std::span<const Affine3d> maps,
                                            std::span<const double> model_areas) {
  SearchSample sample = make_sample(points, maps, model_areas);
  double least = fuzzy_area(sample.points, sample.maps, sample.model_areas);
  Affine3d best;
  for (double step = kFirstStep; step > kLastStep; step /= 2)
    for (int axis = 0; axis < 3; ++axis)
      for (const double t : {step, -step}) {
        const Affine3d turn = turn_about(axis, t);
        std::vector<Affine3d> turned = followed_by(turn, sample.maps);
        const double area = fuzzy_area(sample.points, turned, sample.model_areas);
        if (!(area < least)) continue;
        least = area;
        sample.maps = std::move(turned);
        best = turn * best;
        break;
      }
  std::vector<Affine3d> result = followed_by(best, maps);
  if (fuzzy_area(points, result, model_areas) < fuzzy_area(points, maps, model_areas))
    return result;
  return {maps.begin(), maps.end()};
}

}  // namespace mdk
