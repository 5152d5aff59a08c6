// Which rays of a beam meet the mesh, behind run-time dispatch. docs/lighting.md explains the
// geometry.
#pragma once

#include <cstdint>
#include <span>

#include "common/math/aabb.h"
#include "common/math/affine3.h"
#include "common/trace/kernels/frame_cache.h"
#include "common/trace/kernels/tile_kernels.h"
#include "common/trace/ray_beam.h"

namespace mdk {

/// How forms over the world read in a basis (the world's own, or a cluster's), for boxes inside its
/// bounds. A plane's normal n becomes cofactor n, so no map need be inverted: near singular ones
/// only cull less.
struct BeamSpace {
  Affine3d local_from_world;
  Vec3d cofactor[3];       ///< columns: (cofactor n) . q = det (n . p) for q the image of p
  double det = 1;          ///< of the linear part, its size
  double rounding = 0;     ///< bounds what the cofactors' columns may have lost, per component
  Vec3d reach;             ///< of local coordinates from 0
  double world_reach = 0;  ///< of the mesh from a beam's origin, summed over axes
};

/// A cluster's basis, or the world's, for boxes inside `bounds`. `mesh` holds all that beams start
/// from and may meet.
BeamSpace make_beam_space(const Affine3d& local_from_world, const Aabb& bounds, const Aabb& mesh);

/// Structures with the basis their boxes are in.
struct BeamBvh {
  std::span<const WideBvhNode> nodes;
  std::uint32_t first_leaf;  ///< leaf i is block `first_leaf` + i
  const BeamSpace* space;
};
struct BeamTopLevel {
  BeamBvh tree;
  std::span<const std::uint32_t> cluster_of_leaf;
  std::span<const BeamBvh> clusters;
};
struct BeamKd {
  KdTreeView tree;
  const BeamSpace* space;
};

/// The corners of a block's triangles, side by side.
struct alignas(64) PosedBlock {
  float x[3][kBlockTriangles], y[3][kBlockTriangles], z[3][kBlockTriangles];
};
using PosedBlockCache = FrameCache<PosedBlock, 1 << 18>;

/// The present triangles leaf by leaf.
struct BeamBlocks {
  std::span<const TriangleBlock> blocks;
  const Vec3f* positions;
  PosedBlockCache* cache;  ///< in which the frame was begun
};

/// All find the same rays, bit for bit, on every machine: structures only choose which triangles
/// are tested.
void occlude_beam_brute_force(const TriangleSoup& soup, RayBeam& beam);
void occlude_beam_bvh(const BeamBvh& tree, const BeamBlocks& blocks, RayBeam& beam);
void occlude_beam_two_level_bvh(const BeamTopLevel& top, const BeamBlocks& blocks, RayBeam& beam);
void occlude_beam_kd(const BeamKd& tree, const TriangleSoup& soup, RayBeam& beam,
                     TileScratch& scratch);
void occlude_beam_two_level_kd(const BeamKd& top, std::span<const BeamKd> clusters,
                               const TriangleSoup& soup, RayBeam& beam, TileScratch& scratch);

}  // namespace mdk
