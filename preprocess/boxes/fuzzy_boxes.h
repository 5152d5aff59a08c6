// Fuzzy boxes that hold at every real time (docs/method.md, time between keys).
//
// Between two keys a vertex moves linearly, v(s) = v0 + s (v1 - v0), and its cluster's map is the
// inverse of X(s) = X0 + s (X1 - X0) (common/math/affine_path.h). By Cramer's rule each local
// coordinate is a quotient of cubics in s, for x:
//
//     det(v(s) - o(s), y(s), z(s)) / det(x(s), y(s), z(s)),   X = (x y z | o).
//
// With Bernstein coefficients n_k above and d_k below, all d_k of one sign, it is a convex
// combination of the four n_k / d_k: a box over these control points of all intervals holds the
// curve. A vertex that obeys its cluster exactly has all four in one place. Where the map itself is
// interpolated, the curve is a quadratic, which has four such control points, too.
//
// What tracing really computes differs a little: it rounds v0 + s (v1 - v0) to float. Three
// roundings (difference, product, sum) err by at most 2^-24 (2 |v1 - v0| + max |v|) per world
// coordinate; mapped through |A| that is added on all sides.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/math/aabb.h"
#include "common/math/affine3.h"
#include "common/motion/model.h"
#include "common/motion/pose_sequence.h"
#include "preprocess/decomposition.h"
#include "preprocess/options.h"
#include "preprocess/pose/pose_space.h"

namespace mdk {

/// Per triangle, in the order of `members.triangles`: its box in its cluster's local basis at all
/// times of a segment, or at its keys. `local_from_world`: F * K as stored, key-major. Computed in
/// double, rounded outward. Cost: O(keys of the segment * vertices); runs in parallel.
std::vector<Aabb> fuzzy_boxes(const PoseSequence& sequence, const ClusterMembers& members,
                              std::span<const Affine3f> local_from_world, const Segment& keys,
                              BetweenKeys between);

/// Per triangle, in the order of `members.triangles`: a box that holds it in every pose of the
/// space, in its cluster's basis. `bones`: K. Throws Error (kBadInput) where a bone that must be
/// inverted is flat.
std::vector<Aabb> pose_space_boxes(const PoseSpace& space, const ClusterMembers& members,
                                   std::span<const ClusterBone> bones);

/// Per key and cluster (F * K, key-major): world boxes whose linear interpolation between keys of a
/// clip, done in float, holds every vertex of the cluster as tracing rounds it.
std::vector<Aabb> cluster_world_boxes(const PoseSequence& sequence, const ClusterMembers& members);

}  // namespace mdk
