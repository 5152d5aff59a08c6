#include "common/motion/cluster_vertices.h"

#include <algorithm>
#include <utility>

namespace mdk {
namespace {

constexpr std::uint32_t kNone = 0xffffffffu;

/// Ascending, each once.
void tidy(std::vector<std::uint32_t>& numbers) {
  std::ranges::sort(numbers);
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
}

}  // namespace

ClusterVertices::ClusterVertices(const Model& model) {
  const std::uint32_t clusters = model.cluster_count();
  std::vector<std::uint32_t> owner(model.vertex_count, kNone), last_user(model.vertex_count, kNone);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> border;  // vertex, cluster that uses it
  std::vector<std::uint32_t> present;
  for (std::uint32_t c = 0; c < clusters; ++c) {
    const Cluster& cluster = model.clusters[c];
    present.clear();
    for (const Triangle& t :
         model.triangles.subspan(cluster.first_triangle, cluster.triangle_count))
      for (const std::uint32_t v : t.v) {
        if (last_user[v] == c) continue;
        last_user[v] = c;
        if (owner[v] == kNone) owner[v] = c;
        if (owner[v] != c) border.emplace_back(v, c);
        if (present.empty() || present.back() != owner[v]) present.push_back(owner[v]);
      }
    tidy(present);
    owners_.items.insert(owners_.items.end(), present.begin(), present.end());
    owners_.end_list();
  }

  std::vector<std::vector<VertexRange>> runs(clusters);
  for (std::uint32_t v = 0; v < model.vertex_count; ++v) {
    if (owner[v] == kNone) continue;
    std::vector<VertexRange>& mine = runs[owner[v]];
    if (mine.empty() || mine.back().end != v) mine.push_back({v, v});
    ++mine.back().end;
  }
  for (const std::vector<VertexRange>& mine : runs) {
    owned_.items.insert(owned_.items.end(), mine.begin(), mine.end());
    owned_.end_list();
  }

  std::vector<std::vector<std::uint32_t>> neighbours(clusters);
  std::ranges::sort(border);
  for (std::size_t i = 0; i < border.size();) {
    const std::uint32_t v = border[i].first;
    present.assign(1, owner[v]);
    for (; i < border.size() && border[i].first == v; ++i) present.push_back(border[i].second);
    for (const std::uint32_t a : present)
      neighbours[a].insert(neighbours[a].end(), present.begin(), present.end());
  }
  for (std::uint32_t c = 0; c < clusters; ++c) {
    neighbours[c].push_back(c);
    tidy(neighbours[c]);
    around_.items.insert(around_.items.end(), neighbours[c].begin(), neighbours[c].end());
    around_.end_list();
  }
}

}  // namespace mdk
