// ClusterPoints: the vertices of one cluster in some poses, gathered so that kernels run over them
// without a gap: what maps are fitted to and boxes are measured on.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/math/aabb.h"
#include "common/math/affine3.h"
#include "common/math/vec3.h"
#include "preprocess/boxes/cost.h"
#include "preprocess/decomposition.h"
#include "preprocess/pose/pose_table.h"
#include "preprocess/simd/point_kernels.h"

namespace mdk {

/// R rows (poses), n vertices. Each row is centred on its weighted mean, so that float holds it
/// well.
struct ClusterPoints : PointArrays {
  using PointArrays::PointArrays;

  std::uint32_t row_count = 0, vertex_count = 0;
  std::size_t stride = 0;              ///< vertex_count rounded up to kSumLanes; the rest is zero
  std::vector<Vec3d> centers;          ///< R: table coordinates of each row's origin
  std::vector<float> weights;          ///< stride: corners that use the vertex, 0 past the end
  std::vector<std::uint32_t> corners;  ///< 3 per triangle: vertices 0..n-1

  std::size_t triangle_count() const { return corners.size() / 3; }
  std::size_t row_offset(std::uint32_t row) const { return row * stride; }
  PointRow row(std::uint32_t row) const { return from(row_offset(row)); }
};

/// Positions in a space that all rows are mapped into: n vertices each, padded like ClusterPoints.
using PointTargets = PointArrays;

/// Cluster `cluster` of `members` in all rows of the table. Cost: O(rows * vertices).
ClusterPoints gather_points(const PoseTable& table, const ClusterMembers& members,
                            std::uint32_t cluster);

/// The same at all keys of a sequence, in units of `unit`, not centred on anything but the rows.
ClusterPoints gather_points(const PoseSequence& sequence, const ClusterMembers& members,
                            std::uint32_t cluster, double unit);

/// Some of the triangles of `points` (indices into its triangles, rising) with their vertices.
ClusterPoints gather_subset(const ClusterPoints& points, std::span<const std::uint32_t> triangles);

/// The chosen rows, in their order.
ClusterPoints gather_rows(const ClusterPoints& points, std::span<const std::uint32_t> rows);

/// One row's positions as targets.
PointTargets row_targets(const ClusterPoints& points, std::uint32_t row);

/// Per vertex the sum over rows of its squared distance from its target.
/// Cost: O(rows * vertices).
std::vector<float> point_residuals(const ClusterPoints& points, std::span<const Affine3d> maps,
                                   const PointTargets& targets);

/// Boxes of mapped vertices over all rows: one array per side, padded like ClusterPoints.
struct PointBoxes {
  std::vector<float> lo[3], hi[3];

  BoxRow row() {
    return {{lo[0].data(), lo[1].data(), lo[2].data()}, {hi[0].data(), hi[1].data(), hi[2].data()}};
  }

  /// The middles.
  PointTargets centers() const;

  /// All empty.
  void reset(std::size_t count);

  /// Box of three vertices.
  Aabb triangle(const std::uint32_t* corners) const {
    Aabb box;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const float *l = lo[axis].data(), *h = hi[axis].data();
      box.lo[axis] = std::min(std::min(l[corners[0]], l[corners[1]]), l[corners[2]]);
      box.hi[axis] = std::max(std::max(h[corners[0]], h[corners[1]]), h[corners[2]]);
    }
    return box;
  }
};

/// Weights as kernels take them.
struct FloatWeights {
  float w[3];  ///< xy, yz, zx
};
inline FloatWeights to_float(const AreaWeights& weights) {
  return {{static_cast<float>(weights.xy), static_cast<float>(weights.yz),
           static_cast<float>(weights.zx)}};
}

/// `maps`: R, from centred row coordinates. Cost: O(rows * vertices).
PointBoxes mapped_boxes(const ClusterPoints& points, std::span<const Affine3d> maps);

/// Of the boxes of all triangles.
FaceSums face_sums(const ClusterPoints& points, const PointBoxes& boxes);

/// Area of each triangle's box.
std::vector<float> triangle_areas(const ClusterPoints& points, PointBoxes& boxes,
                                  const AreaWeights& weights);

/// First each map, then `turn`.
std::vector<Affine3d> followed_by(const Affine3d& turn, std::span<const Affine3d> maps);

/// Maps from centred row coordinates as maps from table coordinates, and back.
std::vector<Affine3d> from_table(const ClusterPoints& points, std::span<const Affine3d> centered);
std::vector<Affine3d> from_centered(const ClusterPoints& points, std::span<const Affine3d> table);

}  // namespace mdk
