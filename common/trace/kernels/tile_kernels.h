// The SIMD kernels of tracing, behind run-time dispatch: plain data in, closest hits out.
// docs/kernels.md explains the geometry.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/math/aabb.h"
#include "common/math/affine3.h"
#include "common/motion/posed_mesh.h"
#include "common/structures/kd_tree.h"
#include "common/structures/wide_bvh.h"
#include "common/trace/camera.h"
#include "common/trace/frame_stats.h"
#include "common/trace/hit_buffer.h"
#include "common/trace/kernels/frustum_forms.h"
#include "common/trace/kernels/triangle_block.h"

namespace mdk {

/// From a world point to the image: with p = m (v - origin), p.z is the depth t along the view axis
/// and (p.x / p.z, p.y / p.z) the image point in pixels.
struct PixelFromWorld {
  float m[3][3];
  Vec3f origin;
};

PixelFromWorld make_pixel_from_world(const PinholeRays& rays);

/// One tile of 16x16 pixels with its upper left pixel at (x, y), a multiple of 16.
struct TileRays {
  const PinholeRays* rays;
  const PixelFromWorld* pixel_from_world;
  std::uint32_t x, y;
};

/// What is tested in the leaves: the present triangles in world space.
struct TriangleSoup {
  const Triangle* triangles;
  const Vec3f* positions;
  std::uint32_t triangle_count;
};

/// The present triangles leaf by leaf.
struct BlockSoup {
  std::span<const TriangleBlock> blocks;
  const Vec3f* positions;
  ProjectionCache* cache;  ///< what this frame has projected; null: projected anew for every tile
};

/// Per-thread memory of the kernels: which triangles and clusters this tile has already seen.
struct TileScratch {
  std::vector<std::uint32_t> triangle_stamps, cluster_stamps;
  std::uint32_t serial = 0;
  ProjectedBlock block;

  /// Begins a tile: afterwards nothing has been seen. Grows the stamps on first use.
  void begin_tile(std::size_t triangles, std::size_t clusters);
};

/// A kd-tree and the frame's frusta in its basis.
struct KdView {
  KdTreeView tree;
  FrustumForms forms;
};

/// A hierarchy and the frame's frusta in its basis; its leaf i is block `first_leaf` + i.
struct BvhView {
  std::span<const WideBvhNode> nodes;
  std::uint32_t first_leaf;
  FrustumForms forms;
};

/// A hierarchy over clusters, one a leaf.
struct TopLevelView {
  const BvhView& tree;
  std::span<const std::uint32_t> cluster_of_leaf;
  std::span<const BvhView> clusters;
  const PosedMesh& mesh;  ///< clusters are posed when a tile first enters them
};

/// A kd-tree over clusters.
struct TopLevelKdView {
  const KdView& tree;
  std::span<const KdView> clusters;
  const PosedMesh& mesh;  ///< as above
};

/// Each returns whether a ray hits; `hits` is written whole then, and else left alone.
bool trace_tile_brute_force(const TileRays& tile, const TriangleSoup& soup, TileHits& hits,
                            TileScratch& scratch, TraceCounters* counters);
bool trace_tile_kd(const TileRays& tile, const KdView& tree, const TriangleSoup& soup,
                   TileHits& hits, TileScratch& scratch, TraceCounters* counters);
bool trace_tile_two_level_kd(const TileRays& tile, const TopLevelKdView& top,
                             const TriangleSoup& soup, TileHits& hits, TileScratch& scratch,
                             TraceCounters* counters);
bool trace_tile_bvh(const TileRays& tile, const BvhView& tree, const BlockSoup& soup,
                    TileHits& hits, TileScratch& scratch, TraceCounters* counters);
bool trace_tile_two_level_bvh(const TileRays& tile, const TopLevelView& top, const BlockSoup& soup,
                              TileHits& hits, TileScratch& scratch, TraceCounters* counters);

}  // namespace mdk
