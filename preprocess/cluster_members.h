// ClusterMembers: an assignment of triangles to clusters, seen from the clusters' side.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/motion/pose_sequence.h"

namespace mdk {

/// Compressed lists of K clusters over T triangles. A vertex stands once in the list of every
/// cluster that uses it.
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
  std::span<const std::uint32_t> triangles_of(std::uint32_t cluster) const {
    return std::span(triangles).subspan(triangle_begin[cluster],
                                        triangle_begin[cluster + 1] - triangle_begin[cluster]);
  }
};

/// `cluster_of_triangle` has one entry below `cluster_count` per triangle. Cost: O(T + K +
/// vertices).
ClusterMembers make_cluster_members(std::span<const Triangle> triangles,
                                    std::span<const std::uint32_t> cluster_of_triangle,
                                    std::uint32_t cluster_count, std::uint32_t vertex_count);

/// Vertices in the order in which the clusters first use them, so that those of a cluster lie
/// together; vertices no cluster uses are left out.
std::vector<std::uint32_t> cluster_order(const ClusterMembers& members, std::uint32_t vertex_count);

}  // namespace mdk
