// One ray at a time: which clusters it meets, sixteen boxes at once, then through a cluster's
// eight-wide hierarchy: eight boxes, then eight triangles at once. docs/ray-queries.md tells why no
// ray slips between two triangles and why no box hides a hit.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "common/math/affine3.h"
#include "common/structures/wide_bvh.h"
#include "common/trace/kernels/triangle_block.h"

namespace mdk {

/// A ray against boxes of one basis. Each plane is moved outward by a slack, which is why there are
/// two origins: one for low sides and one for high sides.
struct BoxRay {
  float origin_for_low[3], origin_for_high[3];
  float inverse[3];  ///< of the direction, finite
};

/// The ray `origin` + t `direction` in a basis, for boxes inside `bounds` (of that basis).
/// `world_slack`: what boxes must give way by in the world, for the triangle test's sake.
BoxRay make_box_ray(const Vec3d& origin, const Vec3d& direction, const Affine3d& local_from_world,
                    const Aabb& bounds, double world_slack);

/// Boxes at s between two moments, a column each: rows low x, high x, low y, high y, low z, high z
/// of `stride` floats, a multiple of kMovingBoxLanes, of which `count` are boxes.
inline constexpr std::size_t kMovingBoxLanes = 16;
struct MovingBoxes {
  const float* from;
  const float* to;
  float s;
  std::size_t count, stride;
};

/// A box that a ray meets, and where it enters.
struct MetBox {
  std::uint32_t box;
  float enter;
};

/// The boxes that the ray enters before `t_max`, the nearest first, into `met`, which has room for
/// all. Returns how many.
std::size_t meet_boxes(const BoxRay& ray, const MovingBoxes& boxes, float t_max, MetBox* met);

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

struct WorldRay {
  Vec3d origin, direction;
  float t_min = 0;  ///< hits lie past it
};

enum class RayAim {
  kClosest,  ///< the closest hit, ties to the lower triangle
  kAny,      ///< whether there is one
};

/// A hit so far: nothing farther than `t` counts.
struct RayHit {
  float t = std::numeric_limits<float>::infinity();
  std::uint32_t triangle = 0xffffffffu;  ///< kNoHit: none yet
  float bary1 = 0, bary2 = 0;            ///< barycentric coordinates of corners 1 and 2
};

/// One cluster: its hierarchy, its leaves' triangles, and their vertices at the ray's time.
struct ClusterQuery {
  std::span<const WideBvhNode> nodes;
  const TriangleBlock* blocks;  ///< of leaf 0
  VertexSource vertices;
};

/// Brings `hit` up to date with a cluster.
void intersect_cluster(const WorldRay& ray, const BoxRay& local, const ClusterQuery& cluster,
                       RayAim aim, RayHit& hit);

/// The same without any structure: `blocks` are all tested.
void intersect_blocks(const WorldRay& ray, std::span<const TriangleBlock> blocks,
                      const VertexSource& vertices, RayHit& hit);

}  // namespace mdk
