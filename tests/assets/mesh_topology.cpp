#include "tests/assets/mesh_topology.h"

#include <map>
#include <utility>
#include <vector>

namespace mdk {
namespace {

using DirectedEdge = std::pair<std::uint32_t, std::uint32_t>;

std::map<DirectedEdge, int> directed_edges(std::span<const TriangleIndices> triangles) {
  std::map<DirectedEdge, int> edges;
  for (const auto& t : triangles)
    for (std::size_t i = 0; i < 3; ++i) ++edges[{t[i], t[(i + 1) % 3]}];
  return edges;
}

}  // namespace

std::size_t unmatched_edges(std::span<const TriangleIndices> triangles) {
  const auto edges = directed_edges(triangles);
  std::size_t unmatched = 0;
  for (const auto& [edge, count] : edges)
    unmatched += count != 1 || !edges.contains({edge.second, edge.first});
  return unmatched;
}

std::size_t pinched_vertices(std::span<const TriangleIndices> triangles, std::size_t vertices) {
  // Around each vertex every triangle names a neighbour and the one after it: walk that ring once.
  std::vector<std::map<std::uint32_t, std::uint32_t>> next(vertices);
  for (const auto& t : triangles)
    for (std::size_t i = 0; i < 3; ++i) next[t[i]][t[(i + 1) % 3]] = t[(i + 2) % 3];
  std::size_t pinched = 0;
  for (const auto& ring : next) {
    if (ring.empty()) continue;
    const std::uint32_t start = ring.begin()->first;
    std::size_t steps = 0;
    for (std::uint32_t v = start; steps == 0 || (v != start && steps <= ring.size()); ++steps)
      v = ring.at(v);
    pinched += steps != ring.size();
  }
  return pinched;
}

long euler_characteristic(std::span<const TriangleIndices> triangles, std::size_t vertices) {
  const auto edges = static_cast<long>(directed_edges(triangles).size()) / 2;
  return static_cast<long>(vertices) - edges + static_cast<long>(triangles.size());
}

double enclosed_volume(std::span<const TriangleIndices> triangles,
                       std::span<const Vec3d> positions) {
  double six_volumes = 0;
  for (const auto& [a, b, c] : triangles)
    six_volumes += dot(positions[a], cross(positions[b], positions[c]));
  return six_volumes / 6;
}

}  // namespace mdk
