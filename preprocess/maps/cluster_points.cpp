#include "preprocess/maps/cluster_points.h"

#include <algorithm>
#include <limits>

namespace mdk {
namespace {

std::size_t padded(std::size_t n) { return (n + kSumLanes - 1) / kSumLanes * kSumLanes; }

ClusterPoints empty_points(std::uint32_t rows, std::size_t vertices,
                           const ScratchSpace& scratch = {}) {
  ClusterPoints points(scratch);
  points.row_count = rows;
  points.vertex_count = static_cast<std::uint32_t>(vertices);
  points.stride = padded(vertices);
  points.centers.resize(rows);
  points.resize(rows * points.stride);
  return points;
}

/// `uses`: of each vertex; `position`: of a vertex in a row.
template <class Position>
ClusterPoints centred(std::uint32_t rows, std::span<const std::uint32_t> uses,
                      const ScratchSpace& scratch, const Position& position) {
  ClusterPoints points = empty_points(rows, uses.size(), scratch);
  points.weights.assign(points.stride, 0.0f);
  double weight = 0;
  for (std::size_t i = 0; i < uses.size(); ++i) {
    points.weights[i] = static_cast<float>(uses[i]);
    weight += uses[i];
  }
  std::vector<Vec3d> pose(uses.size());
  for (std::uint32_t row = 0; row < rows; ++row) {
    Vec3d sum;
    for (std::size_t i = 0; i < pose.size(); ++i) {
      pose[i] = position(row, i);
      sum += pose[i] * static_cast<double>(uses[i]);
    }
    points.centers[row] = sum * (1 / weight);
    for (std::size_t i = 0; i < pose.size(); ++i)
      points.set(points.row_offset(row) + i, to_float(pose[i] - points.centers[row]));
  }
  return points;
}

/// `position`: of a vertex of the mesh in a row.
template <class Position>
ClusterPoints centred_cluster(std::uint32_t rows, const ClusterMembers& members,
                              std::uint32_t cluster, const ScratchSpace& scratch,
                              const Position& position) {
  const std::span<const std::uint32_t> vertices = members.vertices_of(cluster);
  const std::uint32_t first = members.vertex_begin[cluster];
  ClusterPoints points =
      centred(rows, std::span(members.uses).subspan(first, vertices.size()), scratch,
              [&](std::uint32_t row, std::size_t i) { return position(row, vertices[i]); });
  for (const std::uint32_t slot : members.corner_slots_of(cluster))
    points.corners.push_back(slot - first);
  return points;
}

/// The maps of a space whose origin is that of the rows' centres, or back, by `sign`.
std::vector<Affine3d> shifted(const ClusterPoints& points, std::span<const Affine3d> maps,
                              double sign) {
  std::vector<Affine3d> result(maps.begin(), maps.end());
  for (std::uint32_t row = 0; row < points.row_count; ++row) {
    const Vec3d shift = result[row].vector(points.centers[row]);
    for (int i = 0; i < 3; ++i) result[row].m[i][3] += sign * shift[static_cast<std::size_t>(i)];
  }
  return result;
}

}  // namespace

ClusterPoints gather_points(const PoseTable& table, const ClusterMembers& members,
                            std::uint32_t cluster) {
  return centred_cluster(
      table.row_count(), members, cluster, {},
      [&](std::uint32_t row, std::uint32_t v) { return table.position(row, v); });
}

ClusterPoints gather_points(const PoseSequence& sequence, const ClusterMembers& members,
                            std::uint32_t cluster, double unit) {
  const double per_unit = 1 / unit;
  const ScratchSpace scratch = sequence.positions.get_allocator().space();
  return centred_cluster(sequence.key_count(), members, cluster, scratch,
                         [&](std::uint32_t key, std::uint32_t v) {
                           return to_double(sequence.pose(key)[v]) * per_unit;
                         });
}

ClusterPoints gather_subset(const ClusterPoints& points, std::span<const std::uint32_t> triangles) {
  constexpr std::uint32_t kUnused = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> slot(points.vertex_count, kUnused), vertices;
  std::vector<std::uint32_t> corners, uses;
  for (const std::uint32_t t : triangles)
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const std::uint32_t v = points.corners[3 * std::size_t{t} + corner];
      if (slot[v] == kUnused) {
        slot[v] = static_cast<std::uint32_t>(vertices.size());
        vertices.push_back(v);
        uses.push_back(0);
      }
      ++uses[slot[v]];
      corners.push_back(slot[v]);
    }
  ClusterPoints subset = centred(points.row_count, uses, {}, [&](std::uint32_t row, std::size_t i) {
    return points.point(points.row_offset(row) + vertices[i]);
  });
  for (std::uint32_t row = 0; row < points.row_count; ++row)
    subset.centers[row] = points.centers[row] + subset.centers[row];
  subset.corners = std::move(corners);
  return subset;
}

ClusterPoints gather_rows(const ClusterPoints& points, std::span<const std::uint32_t> rows) {
  ClusterPoints chosen = empty_points(static_cast<std::uint32_t>(rows.size()), points.vertex_count);
  chosen.weights = points.weights;
  chosen.corners = points.corners;
  for (std::uint32_t i = 0; i < chosen.row_count; ++i) {
    chosen.centers[i] = points.centers[rows[i]];
    const std::size_t from = points.row_offset(rows[i]), to = chosen.row_offset(i);
    std::copy_n(&points.x[from], points.stride, &chosen.x[to]);
    std::copy_n(&points.y[from], points.stride, &chosen.y[to]);
    std::copy_n(&points.z[from], points.stride, &chosen.z[to]);
  }
  return chosen;
}

PointTargets row_targets(const ClusterPoints& points, std::uint32_t row) {
  return points.part(points.row_offset(row), points.stride);
}

std::vector<float> point_residuals(const ClusterPoints& points, std::span<const Affine3d> maps,
                                   const PointTargets& targets) {
  std::vector<float> residuals(points.stride, 0.0f);
  for (std::uint32_t row = 0; row < points.row_count; ++row)
    add_squared_distances(to_float(maps[row]), points.row(row), targets.from(0), points.stride,
                          residuals.data());
  return residuals;
}

PointTargets PointBoxes::centers() const {
  PointTargets middles;
  middles.resize(lo[0].size());
  for (std::size_t i = 0; i < lo[0].size(); ++i)
    middles.set(i, {0.5f * (lo[0][i] + hi[0][i]), 0.5f * (lo[1][i] + hi[1][i]),
                    0.5f * (lo[2][i] + hi[2][i])});
  return middles;
}

void PointBoxes::reset(std::size_t count) {
  for (int axis = 0; axis < 3; ++axis) {
    lo[axis].assign(count, std::numeric_limits<float>::max());
    hi[axis].assign(count, std::numeric_limits<float>::lowest());
  }
}

FaceSums face_sums(const ClusterPoints& points, const PointBoxes& boxes) {
  FaceSums sums;
  for (std::size_t t = 0; t < points.triangle_count(); ++t)
    sums.add(boxes.triangle(&points.corners[3 * t]));
  return sums;
}

std::vector<float> triangle_areas(const ClusterPoints& points, PointBoxes& boxes,
                                  const AreaWeights& weights) {
  std::vector<float> areas(points.triangle_count());
  triangle_box_areas(points.corners.data(), areas.size(), boxes.row(), to_float(weights).w,
                     areas.data());
  return areas;
}

PointBoxes mapped_boxes(const ClusterPoints& points, std::span<const Affine3d> maps) {
  PointBoxes boxes;
  boxes.reset(points.stride);
  std::vector<Affine3f> narrow;
  narrow.reserve(maps.size());
  for (const Affine3d& map : maps) narrow.push_back(to_float(map));
  extend_boxes({narrow.data(), points.row_count, 1, points.from(0), points.stride}, points.stride,
               boxes.row());
  return boxes;
}

std::vector<Affine3d> followed_by(const Affine3d& turn, std::span<const Affine3d> maps) {
  std::vector<Affine3d> result;
  result.reserve(maps.size());
  for (const Affine3d& map : maps) result.push_back(turn * map);
  return result;
}

std::vector<Affine3d> from_table(const ClusterPoints& points, std::span<const Affine3d> centered) {
  return shifted(points, centered, -1);
}

std::vector<Affine3d> from_centered(const ClusterPoints& points, std::span<const Affine3d> table) {
  return shifted(points, table, 1);
}

}  // namespace mdk
