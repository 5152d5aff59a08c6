#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "common/motion/posed_mesh.h"

namespace mdk {
namespace {

/// Random triangles near one another, in clusters of random sizes.
ModelStorage random_clusters(std::uint32_t seed) {
  std::mt19937 random(seed);
  ModelStorage m;
  m.vertex_count = 300;
  for (std::uint32_t i = 0; i < 400; ++i) {
    const auto near = [&] { return static_cast<std::uint32_t>((i / 2 + random() % 40) % 290); };
    m.triangles.push_back({{near(), near(), near()}});
  }
  for (std::uint32_t first = 0; first < 400;) {
    const auto count =
        std::min<std::uint32_t>(static_cast<std::uint32_t>(random() % 50), 400 - first);
    m.clusters.push_back({first, count});
    first += count;
  }
  return m;
}

std::set<std::uint32_t> used_by(const ModelView& model, std::uint32_t c) {
  std::set<std::uint32_t> used;
  for (const Triangle& t :
       model.triangles.subspan(model.clusters[c].first_triangle, model.clusters[c].triangle_count))
    used.insert(t.v, t.v + 3);
  return used;
}

bool meet(const std::set<std::uint32_t>& a, const std::set<std::uint32_t>& b) {
  return std::ranges::any_of(a, [&](std::uint32_t v) { return b.contains(v); });
}

TEST(ClusterVertices, EveryUsedVertexHasOneOwnerThatUsesIt) {
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    const ModelStorage storage = random_clusters(seed);
    const ModelView model = storage.view();
    const ClusterVertices vertices(model);
    std::set<std::uint32_t> seen;
    for (std::uint32_t c = 0; c < model.cluster_count(); ++c) {
      const std::set<std::uint32_t> used = used_by(model, c);
      for (const VertexRange& run : vertices.owned(c))
        for (std::uint32_t v = run.begin; v < run.end; ++v) {
          EXPECT_TRUE(used.contains(v));
          EXPECT_TRUE(seen.insert(v).second) << "two owners";
        }
    }
    for (std::uint32_t c = 0; c < model.cluster_count(); ++c)
      for (const std::uint32_t v : used_by(model, c)) EXPECT_TRUE(seen.contains(v));
  }
}

TEST(ClusterVertices, OwnersOfAClusterOwnAllItsCornersAndNoneIsIdle) {
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    const ModelStorage storage = random_clusters(seed);
    const ModelView model = storage.view();
    const ClusterVertices vertices(model);
    for (std::uint32_t c = 0; c < model.cluster_count(); ++c) {
      const std::set<std::uint32_t> used = used_by(model, c);
      std::set<std::uint32_t> owned;
      for (const std::uint32_t owner : vertices.owners(c)) {
        std::set<std::uint32_t> mine;
        for (const VertexRange& run : vertices.owned(owner))
          for (std::uint32_t v = run.begin; v < run.end; ++v) mine.insert(v);
        EXPECT_TRUE(meet(used, mine));
        owned.merge(mine);
      }
      EXPECT_TRUE(std::ranges::includes(owned, used));
    }
  }
}

TEST(ClusterVertices, AroundAreThoseThatShareAVertex) {
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    const ModelStorage storage = random_clusters(seed);
    const ModelView model = storage.view();
    const ClusterVertices vertices(model);
    for (std::uint32_t a = 0; a < model.cluster_count(); ++a)
      for (std::uint32_t b = 0; b < model.cluster_count(); ++b) {
        const bool around = std::ranges::count(vertices.around(a), b) == 1;
        EXPECT_EQ(around, a == b || meet(used_by(model, a), used_by(model, b))) << a << " " << b;
      }
  }
}

}  // namespace
}  // namespace mdk
