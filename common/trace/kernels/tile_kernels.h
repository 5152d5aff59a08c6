// The SIMD kernels of tracing, behind run-time dispatch: plain data in, closest hits out.
// docs/kernels.md explains the geometry.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/math/aabb.h"
#include "common/math/affine3.h"
#include "common/motion/model.h"
#include "common/structures/bvh.h"
#include "common/structures/kd_tree.h"
#include "common/trace/camera.h"
#include "common/trace/frame_stats.h"
#include "common/trace/hit_buffer.h"

namespace mdk {

/// From a world point to the image: with p = m (v - origin), p.z is the depth t along the view axis
/// and (p.x / p.z, p.y / p.z) the image point in pixels.
struct PixelFromWorld {
  float m[3][3];
  Vec3f origin;
};

/// The linear forms that bound tiles in one basis (world, or a cluster's local basis): products of
/// the pinhole's vectors, in double, once per basis and frame. See docs/kernels.md, "Frusta".
struct FrustumBasis {
  Vec3d origin;
  Vec3d corner_x_dv, du_x_corner, du_x_dv;  ///< cross products
  double det = 0;          ///< of (corner, du, dv); its sign tells a mirrored basis
  double plane_error = 0;  ///< bounds the rounding of a side plane's normal, per component
  double depth_error = 0;  ///< the same for the gradient of the depth
};

FrustumBasis make_frustum_basis(const PinholeRays& world_rays);
FrustumBasis make_frustum_basis(const PinholeRays& world_rays, const Affine3d& local_from_world);
PixelFromWorld make_pixel_from_world(const PinholeRays& rays);

/// One tile of 16x16 pixels with its upper left pixel at (x, y), a multiple of 16.
struct TileRays {
  const PinholeRays* rays;
  const PixelFromWorld* pixel_from_world;
  const FrustumBasis* world_basis;
  std::uint32_t x, y;
};

/// What is tested in the leaves: the present triangles in world space.
struct TriangleSoup {
  const Triangle* triangles;
  const Vec3f* positions;
  std::uint32_t triangle_count;
};

/// Per-thread memory of the kernels: which triangles and clusters this tile has already seen.
struct TileScratch {
  std::vector<std::uint32_t> triangle_stamps, cluster_stamps;
  std::uint32_t serial = 0;

  /// Begins a tile: afterwards nothing has been seen. Grows the stamps on first use.
  void begin_tile(std::size_t triangles, std::size_t clusters);
};

/// A cluster as the two-level kernel meets it: its fuzzy tree and the rays' frustum in its basis.
struct ClusterView {
  KdTreeView tree;
  FrustumBasis basis;
};

void trace_tile_brute_force(const TileRays& tile, const TriangleSoup& soup, TileHits& hits,
                            TileScratch& scratch, TraceCounters* counters);
void trace_tile_kd(const TileRays& tile, const KdTreeView& tree, const TriangleSoup& soup,
                   TileHits& hits, TileScratch& scratch, TraceCounters* counters);
void trace_tile_bvh(const TileRays& tile, const Bvh& bvh, const TriangleSoup& soup, TileHits& hits,
                    TileScratch& scratch, TraceCounters* counters);
void trace_tile_two_level_kd(const TileRays& tile, const KdTreeView& top,
                             std::span<const ClusterView> clusters, const TriangleSoup& soup,
                             TileHits& hits, TileScratch& scratch, TraceCounters* counters);

}  // namespace mdk
