#include "common/trace/vertex_normals.h"

#include <algorithm>
#include <atomic>

#include "common/base/parallel.h"

namespace mdk {

VertexNormals::VertexNormals(const Model& model)
    : model_(&model), seen_(model.vertex_count, 0), normals_(model.vertex_count) {
  first_corner_.assign(std::size_t{model.vertex_count} + 1, 0);
  for (const Triangle& t : model.triangles)
    for (std::uint32_t v : t.v) ++first_corner_[v + 1];
  for (std::size_t v = 0; v < model.vertex_count; ++v) first_corner_[v + 1] += first_corner_[v];
  ring_.resize(first_corner_.back());
  std::vector<std::uint32_t> next(first_corner_.begin(), first_corner_.end() - 1);
  for (std::uint32_t t = 0; t < model.triangle_count(); ++t)
    for (std::uint32_t v : model.triangles[t].v) ring_[next[v]++] = t;
}

void VertexNormals::mark_seen(const HitBuffer& hits, std::span<const std::uint32_t> tiles) {
  if (++frame_ == 0) {  // wrapped round: old marks would look new
    std::fill(seen_.begin(), seen_.end(), std::uint8_t{0});
    frame_ = 1;
  }
  parallel_chunks(tiles.size(), 8, [&](std::size_t begin, std::size_t end) {
    std::uint32_t last = kNoHit;
    for (std::size_t i = begin; i < end; ++i)
      for (const std::uint32_t triangle : hits.tile(tiles[i]).triangle) {
        if (triangle == last || triangle == kNoHit) continue;
        last = triangle;
        for (const std::uint32_t v : model_->triangles[triangle].v)
          std::atomic_ref(seen_[v]).store(frame_, std::memory_order_relaxed);
      }
  });
}

void VertexNormals::update(const PosedMesh& mesh, const HitBuffer& hits,
                           std::span<const std::uint32_t> tiles) {
  mark_seen(hits, tiles);
  const std::span<const Vec3f> positions = mesh.positions();
  parallel_chunks(normals_.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      if (seen_[v] != frame_) continue;
      Vec3f sum;  // weighted by area: a cross product is twice its triangle's
      for (std::uint32_t i = first_corner_[v]; i < first_corner_[v + 1]; ++i) {
        const Triangle& t = model_->triangles[ring_[i]];
        const Vec3f& a = positions[t.v[0]];
        sum += cross(positions[t.v[1]] - a, positions[t.v[2]] - a);
      }
      normals_[v] = normalized(sum, Vec3f{});
    }
  });
}

}  // namespace mdk
