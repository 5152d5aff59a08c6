#include "common/trace/residuals.h"

#include <algorithm>
#include <cmath>

#include "common/base/parallel.h"

namespace mdk {

void triangle_residuals(const PosedMesh& mesh, std::span<float> out) {
  const Model& model = mesh.model();
  PosedMesh rest(model);
  rest.set_time(at_key(model.rest_key));
  parallel_chunks(model.cluster_count(), 1, [&](std::size_t c, std::size_t) {
    const auto number = static_cast<std::uint32_t>(c);
    const Affine3d at_rest = rest.cluster_map(number), now = mesh.cluster_map(number);
    // A basis may be stretched against the world; at rest it should not be, and counts as 1.
    const double unit = std::cbrt(std::abs(at_rest.determinant())) * model.rest_diagonal;
    const Cluster& cluster = model.clusters[c];
    for (std::uint32_t t = cluster.first_triangle;
         t < cluster.first_triangle + cluster.triangle_count; ++t) {
      double largest = 0;
      for (const std::uint32_t v : model.triangles[t].v)
        largest = std::max(largest, length(now.point(to_double(mesh.positions()[v])) -
                                           at_rest.point(to_double(rest.positions()[v]))));
      out[t] = unit > 0 ? static_cast<float>(largest / unit) : 0.0f;
    }
  });
}

}  // namespace mdk
