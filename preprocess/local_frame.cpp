#include "preprocess/local_frame.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cstddef>

#include "common/base/parallel.h"

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
  const CostOptions& options;

  std::span<const std::uint32_t> vertices() const {
    const std::uint32_t begin = members.vertex_begin[cluster];
    return std::span(members.vertices).subspan(begin, members.vertex_begin[cluster + 1] - begin);
  }
};

/// p -> rotation (p - origin)
Affine3d rigid_map(const Matrix& rotation, const Eigen::Vector3d& origin) {
  const Eigen::Vector3d shift = -(rotation * origin);
  Affine3d a;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) a.m[i][j] = rotation(i, j);
    a.m[i][3] = shift(i);
  }
  return a;
}

/// Mean and principal axes of the fuzzy positions; the axes are rows of a proper rotation.
struct PrincipalAxes {
  Eigen::Vector3d mean;
  Matrix axes;
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
  const Eigen::SelfAdjointEigenSolver<Matrix> solver(covariance);
  Matrix axes = solver.eigenvectors().transpose();
  if (axes.determinant() < 0) axes.row(0) = -axes.row(0);
  return {sum / count, axes};
}

/// Boxes of the triangles in a basis, summed.
FaceSums fuzzy_faces(const ClusterFacts& facts, std::span<const Affine3d> local_from_row) {
  const std::span<const std::uint32_t> vertices = facts.vertices();
  std::vector<Aabbd> boxes(vertices.size());
  for (std::uint32_t row = 0; row < facts.table.row_count(); ++row)
    for (std::size_t i = 0; i < vertices.size(); ++i)
      boxes[i].extend(local_from_row[row].point(facts.table.position(row, vertices[i])));
  FaceSums sums;
  const std::uint32_t first = facts.members.triangle_begin[facts.cluster];
  const std::uint32_t last = facts.members.triangle_begin[facts.cluster + 1];
  const std::uint32_t first_slot = facts.members.vertex_begin[facts.cluster];
  for (std::uint32_t t = first; t < last; ++t) {
    Aabbd box;
    for (std::size_t corner = 0; corner < 3; ++corner)
      box.extend(boxes[facts.members.corner_slots[std::size_t{3} * t + corner] - first_slot]);
    sums.add(box);
  }
  return sums;
}

ClusterWork work_in_basis(const ClusterFacts& facts, const Affine3d& local_from_rest) {
  std::vector<Affine3d> local_from_row(facts.maps.size());
  for (std::size_t row = 0; row < local_from_row.size(); ++row)
    local_from_row[row] = local_from_rest * facts.maps[row];
  ClusterWork work;
  work.fuzzy_boxes = fuzzy_faces(facts, local_from_row);
  work.weights = mean_area_weights(local_from_row, facts.model_areas, facts.options);
  return work;
}

double mean_hit_probability(const ClusterFacts& facts) {
  double sum = 0, rows = 0;
  for (std::uint32_t row = 0; row < facts.table.row_count(); ++row) {
    if (!(facts.model_areas[row] > 0)) continue;
    Aabbd box;
    for (const std::uint32_t v : facts.vertices()) box.extend(facts.table.position(row, v));
    sum += box.surface_area() / facts.model_areas[row];
    rows += 1;
  }
  return rows > 0 ? sum / rows : 1;
}

}  // namespace

std::vector<double> model_box_areas(const PoseTable& table) {
  std::vector<double> areas(table.row_count());
  parallel_chunks(areas.size(), 8, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) {
      Aabbd box;
      for (std::uint32_t v = 0; v < table.vertex_count; ++v)
        box.extend(table.position(static_cast<std::uint32_t>(row), v));
      areas[row] = box.surface_area();
    }
  });
  return areas;
}

LocalFrames choose_local_frames(const PoseTable& table, const ClusterMembers& members,
                                std::span<const Affine3d> maps, const CostOptions& options) {
  const std::uint32_t clusters = members.cluster_count();
  const std::vector<double> areas = model_box_areas(table);
  LocalFrames result;
  result.local_from_rest.resize(clusters);
  result.clusters.resize(clusters);
  parallel_chunks(clusters, 1, [&](std::size_t begin, std::size_t) {
    const ClusterFacts facts{table,
                             members,
                             static_cast<std::uint32_t>(begin),
                             maps.subspan(begin * table.row_count(), table.row_count()),
                             areas,
                             options};
    const PrincipalAxes principal = principal_axes(facts);
    const Affine3d plain = rigid_map(Matrix::Identity(), principal.mean);
    const Affine3d turned = rigid_map(principal.axes, principal.mean);
    const ClusterWork plain_work = work_in_basis(facts, plain);
    const ClusterWork turned_work = work_in_basis(facts, turned);
    const bool turn = turned_work.fuzzy_boxes.area(turned_work.weights) <
                      plain_work.fuzzy_boxes.area(plain_work.weights);
    result.local_from_rest[begin] = turn ? turned : plain;
    result.clusters[begin] = turn ? turned_work : plain_work;
    result.clusters[begin].hit_probability = mean_hit_probability(facts);
  });
  return result;
}

}  // namespace mdk
