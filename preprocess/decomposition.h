// What a decomposition consists of, in the order in which it comes about: triangles are assigned to
// clusters, clusters get lists of their members and a map at every key, time is cut into segments.
// Each stage is given what the stages before it have made, as const, and returns its own part.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "common/math/aabb.h"
#include "common/math/affine3.h"
#include "common/motion/model.h"
#include "common/motion/pose_sequence.h"
#include "preprocess/options.h"

namespace mdk {

/// Which cluster each of T triangles is in.
struct Assignment {
  std::vector<std::uint32_t> cluster_of_triangle;  ///< T, each below the count
  std::uint32_t cluster_count = 0;                 ///< each has a triangle
};

/// Renumbers the clusters in use to 0..K-1, keeping their order; the others are dropped.
Assignment make_assignment(std::vector<std::uint32_t> cluster_of_triangle);

/// All triangles in cluster 0; there must be one.
Assignment one_cluster(std::size_t triangle_count);

/// The clusters after a step of their growth, on the keys that were looked at then.
struct GrowthStep {
  std::uint32_t clusters = 0;
  /// Per triangle corner and key, about the rest pose or, where boxes decide, about the boxes'
  /// middles: in table units (pose/pose_table.h), in DecomposeStats in rest pose diagonals.
  double residual_rms = 0;
  double sah_cost = 0;    ///< expected work per ray that hits the model (docs/method.md, cost)
  double fuzzy_area = 0;  ///< summed area of the fuzzy boxes, in areas of the model's box
};

using OnGrowthStep = std::function<void(const GrowthStep&)>;

enum class StopReason {
  kNone,     ///< nothing was grown
  kCost,     ///< more clusters would cost more than they save
  kPercent,  ///< another one would lower the residual by too little
  kCount,    ///< as many as requested
  kLimit,    ///< as many as there may be
  kBones,    ///< a cluster for each bone
};

/// "cost" and so on, as reports have it.
const char* stop_reason_id(StopReason reason);

/// Clusters, and how they came about.
struct Growth : Assignment {
  std::uint32_t rest_key = 0;
  std::vector<GrowthStep> steps;
  StopReason stop_reason = StopReason::kNone;
};

/// An assignment seen from the clusters' side: compressed lists of K clusters over T triangles. A
/// vertex stands once in the list of every cluster that uses it.
struct ClusterMembers {
  std::vector<std::uint32_t> triangle_begin;  ///< K + 1
  std::vector<std::uint32_t> triangles;       ///< T, by cluster, in source order within each
  std::vector<std::uint32_t> vertex_begin;    ///< K + 1
  std::vector<std::uint32_t> vertices;        ///< by cluster, in order of first use
  std::vector<std::uint32_t> uses;            ///< beside `vertices`: corners that use the vertex
  std::vector<std::uint32_t> corner_slots;    ///< 3 T, beside `triangles`: index into `vertices`

  std::uint32_t cluster_count() const {
    return static_cast<std::uint32_t>(triangle_begin.size()) - 1;
  }
  std::span<const std::uint32_t> triangles_of(std::size_t cluster) const {
    return std::span(triangles).subspan(triangle_begin[cluster],
                                        triangle_begin[cluster + 1] - triangle_begin[cluster]);
  }
  std::span<const std::uint32_t> vertices_of(std::size_t cluster) const {
    return std::span(vertices).subspan(vertex_begin[cluster],
                                       vertex_begin[cluster + 1] - vertex_begin[cluster]);
  }
  /// Three per triangle of the cluster.
  std::span<const std::uint32_t> corner_slots_of(std::size_t cluster) const {
    return std::span(corner_slots)
        .subspan(std::size_t{3} * triangle_begin[cluster], 3 * triangles_of(cluster).size());
  }
};

/// Cost: O(T + K + vertices).
ClusterMembers make_cluster_members(std::span<const Triangle> triangles,
                                    const Assignment& assignment, std::uint32_t vertex_count);

/// Vertices in the order in which the clusters first use them, so that those of a cluster lie
/// together; vertices no cluster uses are left out.
std::vector<std::uint32_t> cluster_order(const ClusterMembers& members, std::uint32_t vertex_count);

/// Distances between where the maps take vertices and where they rest, over all keys and triangle
/// corners, world lengths.
struct ResidualStats {
  double rms = 0, max = 0;
};

/// The map of every cluster at every key, as the model stores them.
struct KeyMaps {
  std::vector<Affine3f> local_from_world;  ///< F * K, key-major
  ResidualStats residual;
  double refine_gain = 0;  ///< share by which refinement lowered the summed area of the fuzzy boxes
};

/// A sequence taken apart.
struct Decomposition {
  Growth growth;
  ClusterMembers members;
  std::vector<ClusterBone> bones;  ///< K where clusters follow bones, else none
  KeyMaps maps;
  std::optional<QuantizedPoses> quantized;  ///< what the sequence's positions were decoded from
  std::vector<Segment> segments;
  BetweenKeys between = BetweenKeys::kBound;
  std::vector<Aabb> pose_space_boxes;  ///< T in the members' order where a pose space is bounded
};

// Each throws std::logic_error, which says what is wrong, where a structure breaks its promises: a
// bug in this room, never a user's mistake. For tests and debug builds.

/// Every triangle is in one cluster that exists, every cluster has a triangle.
void validate(const Assignment& assignment, std::size_t triangle_count);

/// Every triangle stands in exactly one cluster, and the lists of vertices are those of the
/// triangles.
void validate(const ClusterMembers& members, std::span<const Triangle> triangles);

/// Every interval between keys of a clip, and every clip of one key, lies in exactly one segment.
void validate(std::span<const Segment> segments, std::span<const Clip> clips);

/// All parts, and that they fit each other and the sequence they are of.
void validate(const Decomposition& decomposition, const PoseSequence& sequence);

}  // namespace mdk
