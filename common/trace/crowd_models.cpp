#include "common/trace/crowd_models.h"

#include <algorithm>
#include <cmath>

#include "common/trace/query_keys.h"

namespace mdk {

CrowdModel::CrowdModel(const ModelView& model, std::size_t max_pose_bytes)
    : tracer_(model, max_pose_bytes),
      own_bytes_(tracer_.bytes()),
      keys_(std::make_unique<KeyFacts[]>(model.key_count())) {
  // By the model alone, so that a picture does not depend on how much may be kept.
  constexpr double kMostNormals = 4 << 20;
  if (static_cast<double>(model.key_count()) * model.vertex_count <= kMostNormals) return;
  first_corner_.assign(std::size_t{model.vertex_count} + 1, 0);
  for (const Triangle& t : model.triangles)
    for (const std::uint32_t v : t.v) ++first_corner_[v + 1];
  for (std::size_t v = 0; v < model.vertex_count; ++v) first_corner_[v + 1] += first_corner_[v];
  ring_.resize(first_corner_.back());
  std::vector<std::uint32_t> next(first_corner_.begin(), first_corner_.end() - 1);
  for (std::uint32_t t = 0; t < model.triangle_count(); ++t)
    for (const std::uint32_t v : model.triangles[t].v) ring_[next[v]++] = t;
  own_bytes_ += (first_corner_.size() + ring_.size()) * sizeof(std::uint32_t);
}

std::vector<Vec3f> CrowdModel::positions(std::uint32_t key) const {
  std::vector<Vec3f> decoded(model().vertex_count);
  decode_pose(model(), key, {0, model().vertex_count}, decoded);
  return decoded;
}

const CrowdModel::KeyFacts& CrowdModel::find(std::uint32_t key) const {
  KeyFacts& facts = keys_[key];
  std::call_once(facts.once, [&] {
    const std::vector<Vec3f> decoded = positions(key);
    const Vec3f* at = decoded.data();
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
      const std::vector<Vec3f> decoded = positions(key);
      const Vec3f* at = decoded.data();
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
