#include "preprocess/maps/cluster_points.h"

#include <algorithm>
#include <limits>

namespace mdk {
namespace {

std::size_t padded(std::size_t n) { return (n + kSumLanes - 1) / kSumLanes * kSumLanes; }

void resize(ClusterPoints& points, std::uint32_t rows, std::uint32_t vertices) {
  points.row_count = rows;
  points.vertex_count = vertices;
  points.stride = padded(vertices);
  points.centers.resize(rows);
  for (std::vector<float>* a : {&points.x, &points.y, &points.z})
    a->assign(rows * points.stride, 0.0f);
  points.weights.assign(points.stride, 0.0f);
}

/// `position`: of a vertex in a row.
template <class Position>
ClusterPoints gathered(const ClusterMembers& members, std::uint32_t cluster, std::uint32_t rows,
                       const Position& position) {
  const std::uint32_t first = members.vertex_begin[cluster];
  const std::uint32_t count = members.vertex_begin[cluster + 1] - first;
  ClusterPoints points;
  resize(points, rows, count);
  double weight = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    points.weights[i] = static_cast<float>(members.uses[first + i]);
    weight += members.uses[first + i];
  }
  std::vector<Vec3d> pose(count);
  for (std::uint32_t row = 0; row < rows; ++row) {
    Vec3d sum;
    for (std::uint32_t i = 0; i < count; ++i) {
      pose[i] = position(row, members.vertices[first + i]);
      sum += pose[i] * static_cast<double>(members.uses[first + i]);
    }
    points.centers[row] = sum * (1 / weight);
    const std::size_t at = points.row_offset(row);
    for (std::uint32_t i = 0; i < count; ++i) {
      const Vec3f p = to_float(pose[i] - points.centers[row]);
      points.x[at + i] = p.x;
      points.y[at + i] = p.y;
      points.z[at + i] = p.z;
    }
  }
  const std::span<const std::uint32_t> slots = members.corner_slots_of(cluster);
  points.corners.reserve(slots.size());
  for (const std::uint32_t s : slots) points.corners.push_back(s - first);
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
  return gathered(members, cluster, table.row_count(),
                  [&](std::uint32_t row, std::uint32_t v) { return table.position(row, v); });
}

ClusterPoints gather_points(const PoseSequence& sequence, const ClusterMembers& members,
                            std::uint32_t cluster, double unit) {
  const double per_unit = 1 / unit;
  return gathered(members, cluster, sequence.key_count(), [&](std::uint32_t key, std::uint32_t v) {
    return to_double(sequence.positions[std::size_t{key} * sequence.vertex_count + v]) * per_unit;
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
  ClusterPoints subset;
  resize(subset, points.row_count, static_cast<std::uint32_t>(vertices.size()));
  subset.corners = std::move(corners);
  double weight = 0;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    subset.weights[i] = static_cast<float>(uses[i]);
    weight += uses[i];
  }
  for (std::uint32_t row = 0; row < points.row_count; ++row) {
    const std::size_t from = points.row_offset(row), at = subset.row_offset(row);
    Vec3d sum;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      const std::size_t j = from + vertices[i];
      sum += Vec3d{points.x[j], points.y[j], points.z[j]} * static_cast<double>(uses[i]);
    }
    const Vec3d center = sum * (1 / weight);
    subset.centers[row] = points.centers[row] + center;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      const std::size_t j = from + vertices[i];
      subset.x[at + i] = static_cast<float>(points.x[j] - center.x);
      subset.y[at + i] = static_cast<float>(points.y[j] - center.y);
      subset.z[at + i] = static_cast<float>(points.z[j] - center.z);
    }
  }
  return subset;
}

ClusterPoints gather_rows(const ClusterPoints& points, std::span<const std::uint32_t> rows) {
  ClusterPoints chosen;
  resize(chosen, static_cast<std::uint32_t>(rows.size()), points.vertex_count);
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
  const auto begin = static_cast<std::ptrdiff_t>(points.row_offset(row));
  const auto end = begin + static_cast<std::ptrdiff_t>(points.stride);
  return {{points.x.begin() + begin, points.x.begin() + end},
          {points.y.begin() + begin, points.y.begin() + end},
          {points.z.begin() + begin, points.z.begin() + end}};
}

std::vector<float> point_residuals(const ClusterPoints& points, std::span<const Affine3d> maps,
                                   const PointTargets& targets) {
  std::vector<float> residuals(points.stride, 0.0f);
  for (std::uint32_t row = 0; row < points.row_count; ++row)
    add_squared_distances(to_float(maps[row]), points.row(row), targets.row(), points.stride,
                          residuals.data());
  return residuals;
}

PointTargets PointBoxes::centers() const {
  PointTargets result;
  std::vector<float>* const arrays[3] = {&result.x, &result.y, &result.z};
  for (int axis = 0; axis < 3; ++axis) {
    arrays[axis]->resize(lo[axis].size());
    for (std::size_t i = 0; i < lo[axis].size(); ++i)
      (*arrays[axis])[i] = 0.5f * (lo[axis][i] + hi[axis][i]);
  }
  return result;
}

Aabb PointBoxes::triangle(const std::uint32_t* corners) const {
  Aabb box;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const float *l = lo[axis].data(), *h = hi[axis].data();
    box.lo[axis] = std::min({l[corners[0]], l[corners[1]], l[corners[2]]});
    box.hi[axis] = std::max({h[corners[0]], h[corners[1]], h[corners[2]]});
  }
  return box;
}

FaceSums face_sums(const ClusterPoints& points, const PointBoxes& boxes) {
  FaceSums sums;
  for (std::size_t t = 0; t < points.triangle_count(); ++t)
    sums.add(boxes.triangle(&points.corners[3 * t]));
  return sums;
}

std::vector<float> triangle_areas(const ClusterPoints& points, const PointBoxes& boxes,
                                  const AreaWeights& weights) {
  std::vector<float> areas(points.triangle_count());
  for (std::size_t t = 0; t < areas.size(); ++t)
    areas[t] = static_cast<float>(
        weights.area(to_double(boxes.triangle(&points.corners[3 * t]).extent())));
  return areas;
}

PointBoxes mapped_boxes(const ClusterPoints& points, std::span<const Affine3d> maps) {
  PointBoxes boxes;
  for (int axis = 0; axis < 3; ++axis) {
    boxes.lo[axis].assign(points.stride, std::numeric_limits<float>::max());
    boxes.hi[axis].assign(points.stride, std::numeric_limits<float>::lowest());
  }
  const BoxRow sides = boxes.row();
  for (std::uint32_t row = 0; row < points.row_count; ++row)
    extend_boxes(to_float(maps[row]), points.row(row), points.stride, sides);
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
