// Sums and boxes over rows of points: what fitting maps and measuring fuzzy boxes spend their time
// on. The results are the same on every instruction set: sums are taken in kSumLanes separate lanes
// and added up in one order, nothing is fused.
#pragma once

#include <cstddef>
#include <cstdint>

#include "common/math/affine3.h"

namespace mdk {

/// Points side by side, one array per coordinate.
struct PointRow {
  const float *x, *y, *z;
};

/// Sums go over so many points at once.
inline constexpr std::size_t kSumLanes = 8;

/// Weighted sums over one row of points p: of w p, and of w p p^T.
struct SecondMoments {
  double first[3];      ///< x, y, z
  double second[3][3];  ///< symmetric
};

/// `n` is a multiple of kSumLanes; points past the last one have weight zero.
SecondMoments second_moments(const PointRow& points, const float* weights, std::size_t n);

/// sum[i][j] = sum over points of w targets_i points_j; `n` as above.
void cross_moments(const PointRow& points, const PointRow& targets, const float* weights,
                   std::size_t n, double (&sum)[3][3]);

/// Boxes of points, one array per side.
struct BoxRow {
  float *lo[3], *hi[3];
};

/// Rows of points, each with its map: row k starts `stride` after row k - 1, and its map is
/// maps[k * map_step].
struct MappedRows {
  const Affine3f* maps;
  std::size_t count, map_step;
  PointRow first;
  std::size_t stride;
};

/// Grows box i until it holds map(point i) of every row, for all i below n. Any n.
void extend_boxes(const MappedRows& rows, std::size_t n, const BoxRow& boxes);

/// Of one row.
inline void extend_boxes(const Affine3f& map, const PointRow& points, std::size_t n,
                         const BoxRow& boxes) {
  extend_boxes({&map, 1, 1, points, 0}, n, boxes);
}

/// areas[t] = 2 (w0 x y + w1 y z + w2 z x), with (x, y, z) the extent of the box of boxes
/// corners[3 t], [3 t + 1] and [3 t + 2]; corners are below 2^31.
void triangle_box_areas(const std::uint32_t* corners, std::size_t triangles, const BoxRow& boxes,
                        const float (&weights)[3], float* areas);

/// out[i] += |map(point i) - target i|^2, for all i below n. Any n.
void add_squared_distances(const Affine3f& map, const PointRow& points, const PointRow& targets,
                           std::size_t n, float* out);

/// One coordinate of mapped points as a multiple of how far each reaches from a middle:
/// u_i = (map (x, y, z, 1) - middle_i) reciprocal_i.
struct ScaledCoordinate {
  float map[4];
  const float *middles, *reciprocals;
};

/// sum[i] += u_i^16, for all i below n. Any n.
void add_sixteenth_powers(const ScaledCoordinate& u, const PointRow& points, std::size_t n,
                          float* sum);

/// sum[j] += the sum over points of w u^15 (x, y, z, 1)_j; `n` is a multiple of kSumLanes.
void add_pulls(const ScaledCoordinate& u, const PointRow& points, const float* weights,
               std::size_t n, double (&sum)[4]);

}  // namespace mdk
