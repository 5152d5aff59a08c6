// One ray at a time (docs/ray-queries.md): through the clusters' boxes at its time, sixteen at
// once, then through a cluster's hierarchy, eight boxes at once, to blocks of sixteen triangles,
// most of which a float test with a bounded error rejects before the test in double decides.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "common/math/affine3.h"
#include "common/structures/wide_bvh.h"
#include "common/trace/hit_buffer.h"
#include "common/trace/kernels/triangle_block.h"
#include "mdk/ray_query.h"

namespace mdk {

class KeyPoses;

struct WorldRay {
  Vec3d origin, direction;  ///< the direction's largest component is in [1, 2)
  float t_min = 0;          ///< hits lie past it
};

enum class RayAim {
  kClosest,  ///< the closest hit, ties to the lower triangle
  kAny,      ///< whether there is one
};

/// A hit so far: nothing farther than `t` counts.
struct RayHit {
  float t = std::numeric_limits<float>::infinity();
  std::uint32_t triangle = kNoHit;
  float bary1 = 0, bary2 = 0;  ///< barycentric coordinates of corners 1 and 2
};

/// Where the vertices are: at s between two poses, as PosedMesh has them.
struct VertexSource {
  const Vec3f* from;
  const Vec3f* to;
  float s;

  Vec3f position(std::uint32_t v) const {
    const Vec3f& a = from[v];
    return s == 0.0f ? a : a + (to[v] - a) * s;
  }
};

/// A leaf of up to sixteen triangles that have up to sixteen vertices: each vertex is fetched once,
/// and its place in `vertex` is what corners name. Unused places repeat the first.
inline constexpr std::uint32_t kBlockVertices = 16;
struct alignas(64) RayBlock {
  std::uint32_t vertex[kBlockVertices];
  std::uint8_t corner[3][kBlockTriangles];
  std::uint8_t count;
  bool has_next;  ///< the next block is of the same leaf
  std::uint32_t triangle[kBlockTriangles];
};
static_assert(sizeof(RayBlock) == 192);

/// Of hierarchies for single rays, which test a node's sixteen boxes at once.
inline constexpr std::uint32_t kRayWidth = 16;
using RayNode = WideNode<kRayWidth>;

/// The hierarchy of one cluster; the links of its leaves are numbers of blocks.
struct RayTree {
  std::span<const RayNode> nodes;
  const RayBlock* blocks;
  float size[4];  ///< the largest |x|, |y|, |z| of all boxes, in the cluster's basis
};

/// Sixteen boxes at a key, side by side: rows low x, high x, low y, high y, low z, high z.
inline constexpr std::size_t kTopWidth = 16;
struct alignas(64) TopBoxes {
  float bounds[6][kTopWidth];
};
/// What they are of: clusters, or other nodes.
struct TopLinks {
  WideBvhChild child[kTopWidth];
  std::uint32_t count;
};

/// world_from_local at a key, with both origins moved to where numbers are small.
struct KeyMap {
  float m[3][4];
};
/// Whether the maps between two keys are the inverses of interpolated KeyMaps (AffinePath), and
/// rounding them to float changes no more than RayModel::world_slack allows for.
inline constexpr std::uint8_t kRegularKey = 1, kRegularInterval = 2;

/// The model at a key.
struct alignas(32) KeyBox {
  float lo[4], hi[4];
};

/// All that rays go through. F keys, K clusters, S segments, N nodes over clusters.
struct RayModel {
  Aabb bounds;     ///< hold it at all times
  Vec3f center;    ///< of the bounds
  float diagonal;  ///< theirs
  std::uint32_t clusters, top_nodes, top_roots;
  const KeyBox* key_boxes;           ///< F
  const TopBoxes* top_boxes;         ///< F * N, key-major, the roots last
  const TopLinks* top_links;         ///< N
  const Affine3f* local_from_world;  ///< F * K, key-major
  const KeyMap* key_maps;            ///< F * K: q -> world_from_local(q + local_center) - center
  const std::uint8_t* map_kinds;     ///< F * K: of the key, and of the interval that begins there
  const Vec3f* local_centers;        ///< K
  const RayTree* trees;              ///< S * K
  const KeyPoses* poses;
};

/// What the ray meets at a time, which lies in `segment`.
QueryHit trace_ray(const RayModel& model, const QueryRay& ray, const KeyInterval& at,
                   std::uint32_t segment, RayAim aim);

/// The same for many, each at a time of its own.
void trace_rays(const RayModel& model, const QueryRay* rays, const KeyInterval* times,
                const std::uint32_t* segments, RayAim aim, QueryHit* hits, std::size_t count);

/// Where the vertices of a block are at one time.
struct alignas(64) PosedRayBlock {
  float x[kBlockVertices], y[kBlockVertices], z[kBlockVertices];
};
/// `posed` and `boxes` have one for each block; behind the source's last vertices, 4 bytes may be
/// read. A box holds the vertices that are finite; a triangle with another cannot be hit.
void pose_blocks(std::span<const RayBlock> blocks, const VertexSource& source, PosedRayBlock* posed,
                 Aabb* boxes);

/// A model at one time, with one hierarchy in the world, whose leaves are numbers of blocks.
struct PosedScene {
  Vec3f center;    ///< of its bounds
  float diagonal;  ///< theirs
  KeyBox bounds;
  std::span<const RayNode> nodes;
  const RayBlock* blocks;
  const PosedRayBlock* posed;
};
QueryHit trace_posed(const PosedScene& scene, const QueryRay& ray, RayAim aim);

/// What triangles without a structure bring `hit` to: every triangle is tested in double.
void test_blocks(const WorldRay& ray, std::span<const TriangleBlock> blocks,
                 const VertexSource& vertices, RayHit& hit);

}  // namespace mdk
