// Fuzzy boxes that hold at every real time (docs/method.md, time between keys).
//
// Between two keys both a vertex and its cluster's map move so that the local position
// A(s) (v0 + s (v1 - v0)) is a quadratic in s: a Bezier curve whose ends are the positions at the
// keys and whose middle control point follows from the position half-way,
//
//     p1 = 2 p(1/2) - (p0 + p2) / 2,        p(1/2) = interpolate(A0, A1, 1/2) (v0 + v1) / 2.
//
// A box over the ends and over the curve's turning point on each axis is the curve's exact box; its
// control points would do too, but where clusters turn fast between keys they double the excess.
// What tracing really computes differs a little: it rounds v0 + s (v1 - v0) to float. Three
// roundings (difference, product, sum) err by at most 2^-24 (2 |v1 - v0| + max |v|) per world
// coordinate; mapped through |A| that is added on all sides.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/math/aabb.h"
#include "common/math/affine3.h"
#include "common/motion/pose_sequence.h"
#include "preprocess/cluster_members.h"

namespace mdk {

/// Whether the curves between keys are looked at.
enum class BetweenKeys {
  kBound,   ///< boxes hold at every time
  kIgnore,  ///< boxes hold at keys only: what GFW06 has, and what tests compare with
};

/// Per triangle, in the order of `members.triangles`: its box in its cluster's local basis.
/// `local_from_world`: F * K as stored, key-major. Computed in double, rounded outward.
/// Cost: O(keys * vertices); runs in parallel.
std::vector<Aabb> fuzzy_boxes(const PoseSequence& sequence, const ClusterMembers& members,
                              std::span<const Affine3f> local_from_world,
                              BetweenKeys between = BetweenKeys::kBound);

/// Per key and cluster (F * K, key-major): world boxes whose linear interpolation between keys of a
/// clip, done in float, holds every vertex of the cluster as tracing rounds it.
std::vector<Aabb> cluster_world_boxes(const PoseSequence& sequence, const ClusterMembers& members);

}  // namespace mdk
