#include "common/trace/seen_vertices.h"

#include <algorithm>
#include <atomic>
#include <cstring>

#include "common/base/parallel.h"

namespace mdk {
namespace {

constexpr std::size_t kChunk = 4096;

/// Calls visit(i) where marks[i] is `mark`. What is seen lies together, and so does what is not.
template <class Visit>
void for_each_marked(std::span<const std::uint8_t> marks, std::uint8_t mark, const Visit& visit) {
  for (std::size_t i = 0; i < marks.size(); ++i) {
    if (marks[i] != mark) {
      const void* next = std::memchr(marks.data() + i, mark, marks.size() - i);
      if (next == nullptr) return;
      i = static_cast<std::size_t>(static_cast<const std::uint8_t*>(next) - marks.data());
    }
    visit(i);
  }
}

/// Threads that mark the same thing store the same byte.
void store(std::uint8_t& place, std::uint8_t mark) {
  std::atomic_ref(place).store(mark, std::memory_order_relaxed);
}

}  // namespace

SeenVertices::SeenVertices(const Model& model)
    : model_(&model),
      seen_triangles_(std::size_t{model.triangle_count()} + 1, 0),
      seen_vertices_(model.vertex_count, 0),
      vertices_(model.vertex_count) {
  first_corner_.assign(std::size_t{model.vertex_count} + 1, 0);
  for (const Triangle& t : model.triangles)
    for (std::uint32_t v : t.v) ++first_corner_[v + 1];
  for (std::size_t v = 0; v < model.vertex_count; ++v) first_corner_[v + 1] += first_corner_[v];
  ring_.resize(first_corner_.back());
  std::vector<std::uint32_t> next(first_corner_.begin(), first_corner_.end() - 1);
  for (std::uint32_t t = 0; t < model.triangle_count(); ++t)
    for (std::uint32_t v : model.triangles[t].v) ring_[next[v]++] = t;
}

void SeenVertices::mark(const HitBuffer& hits, std::span<const std::uint32_t> tiles) {
  if (++frame_ == 0) {  // wrapped round: old marks would look new
    std::fill(seen_triangles_.begin(), seen_triangles_.end(), std::uint8_t{0});
    std::fill(seen_vertices_.begin(), seen_vertices_.end(), std::uint8_t{0});
    frame_ = 1;
  }
  // Without branches: where the next triangle begins cannot be foretold.
  const std::uint32_t none = model_->triangle_count();
  parallel_chunks(tiles.size(), 8, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      for (const std::uint32_t triangle : hits.tile(tiles[i]).triangle)
        store(seen_triangles_[std::min(triangle, none)], frame_);
  });
  parallel_chunks(none, kChunk, [&](std::size_t begin, std::size_t end) {
    const std::span marks(seen_triangles_.data() + begin, end - begin);
    for_each_marked(marks, frame_, [&](std::size_t i) {
      for (const std::uint32_t v : model_->triangles[begin + i].v) store(seen_vertices_[v], frame_);
    });
  });
}

SurfaceVertex SeenVertices::make(std::uint32_t vertex, const Vec3f* positions) const {
  Vec3f sum;  // weighted by area: a cross product is twice its triangle's
  for (std::uint32_t i = first_corner_[vertex]; i < first_corner_[vertex + 1]; ++i) {
    const Triangle& t = model_->triangles[ring_[i]];
    const Vec3f& a = positions[t.v[0]];
    sum += cross(positions[t.v[1]] - a, positions[t.v[2]] - a);
  }
  return {.position = positions[vertex], .normal = normalized(sum, Vec3f{})};
}

void SeenVertices::update(const PosedMesh& mesh, const HitBuffer& hits,
                          std::span<const std::uint32_t> tiles) {
  mark(hits, tiles);
  parallel_chunks(model_->clusters.size(), 1, [&](std::size_t c, std::size_t) {
    const Cluster& cluster = model_->clusters[c];
    const std::uint8_t* marks = seen_triangles_.data() + cluster.first_triangle;
    if (std::memchr(marks, frame_, cluster.triangle_count) != nullptr)
      mesh.require_around(static_cast<std::uint32_t>(c));
  });
  const Vec3f* positions = mesh.posed_so_far();
  parallel_chunks(vertices_.size(), kChunk, [&](std::size_t begin, std::size_t end) {
    const std::span marks(seen_vertices_.data() + begin, end - begin);
    for_each_marked(marks, frame_, [&](std::size_t i) {
      vertices_[begin + i] = make(static_cast<std::uint32_t>(begin + i), positions);
    });
  });
}

}  // namespace mdk
