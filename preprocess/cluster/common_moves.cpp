#include "preprocess/cluster/common_moves.h"

#include <cstddef>

#include "common/math/aabb.h"

namespace mdk {

std::vector<std::uint32_t> halve_largest(const MovingMesh& mesh, std::uint32_t rest_row,
                                         const Assignment& assignment) {
  std::vector<std::size_t> sizes(assignment.cluster_count, 0);
  for (const std::uint32_t c : assignment.cluster_of_triangle) ++sizes[c];
  const auto largest =
      static_cast<std::uint32_t>(std::max_element(sizes.begin(), sizes.end()) - sizes.begin());

  const auto center = [&](std::uint32_t t) {
    Vec3d sum;
    for (const std::uint32_t v : mesh.triangles[t].v) sum += mesh.poses.position(rest_row, v);
    return sum;
  };
  std::vector<std::uint32_t> halved = assignment.cluster_of_triangle, order;
  Aabbd box;
  for (std::uint32_t t = 0; t < halved.size(); ++t)
    if (halved[t] == largest) {
      order.push_back(t);
      box.extend(center(t));
    }
  const Vec3d e = box.extent();
  const std::size_t axis = e.x >= e.y && e.x >= e.z ? 0 : e.y >= e.z ? 1 : 2;
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return center(a)[axis] < center(b)[axis];
  });
  for (std::size_t i = order.size() / 2; i < order.size(); ++i)
    halved[order[i]] = assignment.cluster_count;
  return halved;
}

}  // namespace mdk
