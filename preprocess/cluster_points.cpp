#include "preprocess/cluster_points.h"

#include <algorithm>
#include <limits>

namespace mdk {
namespace {

/// Maps of one cluster must not tumble from key to key in the directions in which it is thin, where
/// only noise speaks: boxes hold between keys, too. So such directions follow the rigid motion.
constexpr FitOptions kPointFit{.noise = 1e-7, .ridge = 1, .keep_orientation = true};

std::size_t padded(std::size_t n) { return (n + kSumLanes - 1) / kSumLanes * kSumLanes; }

void resize(ClusterPoints& points, std::uint32_t rows, std::uint32_t vertices) {
  points.row_count = rows;
  points.vertex_count = vertices;
  points.stride = padded(vertices);
  points.centers.resize(rows);
  for (ScratchList<float>* a : {&points.x, &points.y, &points.z})
    a->assign(rows * points.stride, 0.0f);
  points.weights.assign(points.stride, 0.0f);
}

/// What all rows share when they are fitted to the same targets.
struct TargetSums {
  double weight = 0, first[3] = {}, trace = 0;
};

TargetSums target_sums(const PointTargets& targets, std::span<const float> weights) {
  TargetSums sums;
  for (const float w : weights) sums.weight += static_cast<double>(w);
  const SecondMoments m = second_moments(targets.row(), weights.data(), weights.size());
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

/// `position`: of a vertex in a row.
template <class Position>
ClusterPoints gathered(const ClusterMembers& members, std::uint32_t cluster, std::uint32_t rows,
                       const ScratchSpace& scratch, const Position& position) {
  const std::uint32_t first = members.vertex_begin[cluster];
  const std::uint32_t count = members.vertex_begin[cluster + 1] - first;
  ClusterPoints points;
  points.x = points.y = points.z = ScratchList<float>(scratch);
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
  const std::span<const std::uint32_t> slots =
      std::span(members.corner_slots)
          .subspan(3 * std::size_t{members.triangle_begin[cluster]},
                   3 * members.triangles_of(cluster).size());
  points.corners.reserve(slots.size());
  for (const std::uint32_t s : slots) points.corners.push_back(s - first);
  return points;
}

}  // namespace

ClusterPoints gather_points(const PoseTable& table, const ClusterMembers& members,
                            std::uint32_t cluster) {
  return gathered(members, cluster, table.row_count(), {},
                  [&](std::uint32_t row, std::uint32_t v) { return table.position(row, v); });
}

ClusterPoints gather_points(const PoseSequence& sequence, const ClusterMembers& members,
                            std::uint32_t cluster, double unit) {
  const double per_unit = 1 / unit;
  const ScratchSpace scratch = sequence.positions.get_allocator().space();
  return gathered(
      members, cluster, sequence.key_count(), scratch, [&](std::uint32_t key, std::uint32_t v) {
        return to_double(sequence.positions[std::size_t{key} * sequence.vertex_count + v]) *
               per_unit;
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
    cross_moments(points.row(row), targets.row(), weights.data(), points.stride, cross);
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

std::vector<Affine3d> from_table(const ClusterPoints& points, std::span<const Affine3d> centered) {
  std::vector<Affine3d> result(centered.begin(), centered.end());
  for (std::uint32_t row = 0; row < points.row_count; ++row) {
    const Vec3d shift = result[row].vector(points.centers[row]);
    for (int i = 0; i < 3; ++i) result[row].m[i][3] -= shift[static_cast<std::size_t>(i)];
  }
  return result;
}

std::vector<Affine3d> from_centered(const ClusterPoints& points, std::span<const Affine3d> table) {
  std::vector<Affine3d> result(table.begin(), table.end());
  for (std::uint32_t row = 0; row < points.row_count; ++row) {
    const Vec3d shift = result[row].vector(points.centers[row]);
    for (int i = 0; i < 3; ++i) result[row].m[i][3] += shift[static_cast<std::size_t>(i)];
  }
  return result;
}

}  // namespace mdk
