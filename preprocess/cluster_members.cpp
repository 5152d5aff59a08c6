#include "preprocess/cluster_members.h"

#include <cstddef>

namespace mdk {

ClusterMembers make_cluster_members(std::span<const Triangle> triangles,
                                    std::span<const std::uint32_t> cluster_of_triangle,
                                    std::uint32_t cluster_count, std::uint32_t vertex_count) {
  ClusterMembers members;
  members.triangle_begin.assign(cluster_count + 1, 0);
  for (const std::uint32_t c : cluster_of_triangle) ++members.triangle_begin[c + 1];
  for (std::uint32_t c = 0; c < cluster_count; ++c)
    members.triangle_begin[c + 1] += members.triangle_begin[c];

  members.triangles.resize(triangles.size());
  std::vector<std::uint32_t> next(members.triangle_begin.begin(), members.triangle_begin.end() - 1);
  for (std::size_t t = 0; t < triangles.size(); ++t)
    members.triangles[next[cluster_of_triangle[t]]++] = static_cast<std::uint32_t>(t);

  members.vertex_begin.assign(1, 0);
  members.corner_slots.reserve(3 * triangles.size());
  std::vector<std::uint32_t> slot_of_vertex(vertex_count, 0);
  for (std::uint32_t c = 0; c < cluster_count; ++c) {
    const std::uint32_t first_slot = members.vertex_begin.back();
    for (const std::uint32_t t : members.triangles_of(c)) {
      for (const std::uint32_t v : triangles[t].v) {
        // A slot left by an earlier cluster lies below this cluster's first one or names another
        // vertex.
        std::uint32_t slot = slot_of_vertex[v];
        if (slot < first_slot || slot >= members.vertices.size() || members.vertices[slot] != v) {
          slot = static_cast<std::uint32_t>(members.vertices.size());
          slot_of_vertex[v] = slot;
          members.vertices.push_back(v);
          members.uses.push_back(0);
        }
        ++members.uses[slot];
        members.corner_slots.push_back(slot);
      }
    }
    members.vertex_begin.push_back(static_cast<std::uint32_t>(members.vertices.size()));
  }
  return members;
}

std::vector<std::uint32_t> cluster_order(const ClusterMembers& members,
                                         std::uint32_t vertex_count) {
  std::vector<std::uint32_t> order;
  std::vector<char> met(vertex_count, 0);
  for (const std::uint32_t v : members.vertices) {
    if (!met[v]) order.push_back(v);
    met[v] = 1;
  }
  return order;
}

}  // namespace mdk
