// One ray at a time: which clusters it enters, sixteen boxes at once, then through a cluster's
// eight-wide hierarchy: eight boxes, then eight triangles at once. docs/ray-queries.md tells why no
// ray slips between two triangles and why no box hides a hit.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "common/math/affine3.h"
#include "common/structures/wide_bvh.h"
#include "common/trace/hit_buffer.h"
#include "common/trace/kernels/triangle_block.h"

namespace mdk {

struct WorldRay {
  Vec3d origin, direction;
  float t_min = 0;  ///< hits lie past it
};

/// A ray against boxes of one basis. Each plane is moved outward by a slack, which is why there are
/// two origins: one for low sides and one for high sides.
struct BoxRay {
  float origin_for_low[3], origin_for_high[3];
  float inverse[3];  ///< of the direction, finite
  float t_begin;     ///< what ends before it is not entered
};

/// The ray in a basis, for boxes inside `bounds` (of that basis). `world_slack`: what boxes must
/// give way by in the world, for the triangle test's sake.
BoxRay make_box_ray(const WorldRay& ray, const Affine3d& local_from_world, const Aabb& bounds,
                    double world_slack);

/// Boxes at s between two moments, a column each: rows low x, high x, low y, high y, low z, high z
/// of `stride` floats, a multiple of kMovingBoxLanes, of which `count` are boxes.
inline constexpr std::size_t kMovingBoxLanes = 16;
struct MovingBoxes {
  const float* from;
  const float* to;
  float s;
  std::size_t count, stride;
};

/// A box that a ray enters, and where.
struct EnteredBox {
  std::uint32_t box;
  float enter;
};

/// The boxes that the ray enters before `t_max`, the nearest first, into `entered`, which has
/// room for all. Returns how many.
std::size_t enter_boxes(const BoxRay& ray, const MovingBoxes& boxes, float t_max,
                        EnteredBox* entered);

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

/// Triangles, with a hierarchy over them or without: then all are tested.
struct RayTarget {
  std::span<const WideBvhNode> nodes;
  std::span<const TriangleBlock> blocks;  ///< of leaf i: block i
  VertexSource vertices;                  ///< at the ray's time
};

/// Brings `hit` up to date. `local`: the ray in the basis of the hierarchy, if there is one.
void intersect(const WorldRay& ray, const BoxRay& local, const RayTarget& target, RayAim aim,
               RayHit& hit);

}  // namespace mdk
