#include "common/trace/crowd_models.h"

#include <algorithm>
#include <cmath>

#include "common/trace/query_keys.h"

namespace mdk {

CrowdModel::CrowdModel(const ModelView& model)
    : tracer_(model),
      own_bytes_(tracer_.bytes()),
      keys_(std::make_unique<KeyFacts[]>(model.key_count())) {}

const CrowdModel::KeyFacts& CrowdModel::find(std::uint32_t key) const {
  KeyFacts& facts = keys_[key];
  std::call_once(facts.once, [&] {
    const Vec3f* at = tracer_.rays().poses->key(key);
    float longest_of_all = 0;
    for (const Cluster& cluster : model().clusters) {
      double longest = 0;
      for (const Triangle& t :
           model().triangles.subspan(cluster.first_triangle, cluster.triangle_count))
        for (int k = 0; k < 3; ++k) {
          const Vec3d edge = to_double(at[t.v[k]]) - to_double(at[t.v[(k + 1) % 3]]);
          const double square = dot(edge, edge);
          if (square > longest) longest = square;  // not where a corner is no number: never hit
        }
      facts.longest_edges.push_back(static_cast<float>(std::sqrt(longest) * (1 + 0x1p-20)));
      longest_of_all = std::max(longest_of_all, facts.longest_edges.back());
    }
    facts.longest_edges.push_back(longest_of_all);
    facts.ready.store(true, std::memory_order_release);
  });
  return facts;
}

std::span<const Vec3f> CrowdModel::normals(std::uint32_t key) const {
  KeyFacts& facts = keys_[key];
  if (!facts.has_normals.load(std::memory_order_acquire))
    std::call_once(facts.normals_once, [&] {
      const Vec3f* at = tracer_.rays().poses->key(key);
      facts.normals.resize(model().vertex_count);
      for (const Triangle& t : model().triangles) {
        const Vec3f& a = at[t.v[0]];
        const Vec3f twice = cross(at[t.v[1]] - a, at[t.v[2]] - a);
        for (const std::uint32_t v : t.v) facts.normals[v] += twice;
      }
      for (Vec3f& n : facts.normals) n = normalized(n, Vec3f{});
      cached_.fetch_add(facts.normals.size() * sizeof(Vec3f), std::memory_order_relaxed);
      facts.has_normals.store(true, std::memory_order_release);
    });
  return facts.normals;
}

std::size_t CrowdModel::structure_bytes() const { return own_bytes_; }

std::size_t CrowdModel::cache_bytes() const {
  return tracer_.bytes() - own_bytes_ + cached_.load(std::memory_order_relaxed);
}

}  // namespace mdk
