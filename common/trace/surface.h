// Surfaces: what lies where a ray hit a moving mesh.
#pragma once

#include <cstdint>
#include <mutex>
#include <vector>

#include "common/trace/ray_tracer.h"
#include "mdk/ray_query.h"

namespace mdk {

/// Safe to use from many threads at once; the tracer must outlive it.
class Surfaces {
 public:
  explicit Surfaces(const RayTracer& tracer) : tracer_(tracer) {}

  /// The hit must be one of the model's. Cost: O(1), for kSmoothNormal O(triangles around the
  /// corners), and the first time O(triangles).
  Surface at(const QueryHit& hit, const KeyInterval& time, SurfaceParts parts) const;

 private:
  /// The triangles around each vertex, one list after another.
  struct Around {
    std::vector<std::uint32_t> first, triangles;
  };
  const Around& around() const;
  Vec3f vertex_normal(std::uint32_t vertex, const HeldVertices& vertices) const;
  void set_geometry(const Triangle& triangle, const double (&weight)[3], const KeyInterval& time,
                    bool is_smooth, Surface& surface) const;

  const RayTracer& tracer_;
  mutable std::once_flag once_;
  mutable Around around_;
};

}  // namespace mdk
