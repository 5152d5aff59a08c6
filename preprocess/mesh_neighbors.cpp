#include "preprocess/mesh_neighbors.h"

#include <unordered_set>

namespace mdk {

VertexTriangles make_vertex_triangles(std::span<const Triangle> triangles,
                                      std::uint32_t vertex_count) {
  VertexTriangles lists;
  lists.begin.assign(static_cast<std::size_t>(vertex_count) + 1, 0);
  for (const Triangle& t : triangles)
    for (const std::uint32_t v : t.v) ++lists.begin[v + 1];
  for (std::size_t v = 0; v < vertex_count; ++v) lists.begin[v + 1] += lists.begin[v];
  lists.triangles.resize(3 * triangles.size());
  std::vector<std::uint32_t> next(lists.begin.begin(), lists.begin.end() - 1);
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (const std::uint32_t v : triangles[t].v)
      lists.triangles[next[v]++] = static_cast<std::uint32_t>(t);
  return lists;
}

std::vector<std::uint32_t> grow_patch(std::span<const Triangle> triangles,
                                      const VertexTriangles& neighbors, std::uint32_t seed,
                                      std::size_t min_vertices) {
  std::vector<std::uint32_t> patch{seed}, vertices;
  std::unordered_set<std::uint32_t> in_patch{seed}, seen;
  const auto add_vertices = [&](std::uint32_t triangle) {
    for (const std::uint32_t v : triangles[triangle].v)
      if (seen.insert(v).second) vertices.push_back(v);
  };
  add_vertices(seed);
  for (std::size_t ring_begin = 0;
       ring_begin < vertices.size() && vertices.size() < min_vertices;) {
    const std::size_t ring_end = vertices.size();
    for (std::size_t i = ring_begin; i < ring_end; ++i)
      for (const std::uint32_t t : neighbors.of(vertices[i]))
        if (in_patch.insert(t).second) {
          patch.push_back(t);
          add_vertices(t);
        }
    ring_begin = ring_end;
  }
  return patch;
}

}  // namespace mdk
