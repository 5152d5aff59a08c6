#include "common/trace/brute_force.h"

#include "common/trace/scaled_ray.h"

namespace mdk {

QueryHit brute_force_closest_hit(const ModelView& model, const QueryRay& ray,
                                 const KeyInterval& at) {
  PosedMesh mesh(model);
  mesh.set_time(at);
  return brute_force_closest_hit(mesh, ray);
}

QueryHit brute_force_closest_hit(const PosedMesh& mesh, const QueryRay& ray) {
  const ScaledRay scaled(ray);
  if (!scaled.usable) return {};
  RayHit hit = scaled.nothing_yet();
  const ModelView& model = mesh.model();
  const VertexSource vertices{mesh.positions().data(), mesh.positions().data(), 0};
  TriangleBlock block;
  for (std::uint32_t t = 0; t < model.triangle_count(); ++t) {
    block.push(t, model.triangles[t]);
    if (block.count < kBlockTriangles && t + 1 < model.triangle_count()) continue;
    block.pad();
    test_blocks(scaled.ray, {&block, 1}, vertices, hit);
    block = {};
  }
  return scaled.in_callers_lengths(hit);
}

}  // namespace mdk
