// Refitting and costing a Bvh. Children have higher indices than their parent, so one backward pass
// is bottom up.
#include "common/structures/bvh.h"

#include <cassert>

#include "common/structures/bvh_bins.h"

namespace mdk {

void refit_bvh(Bvh& bvh, std::span<const Aabb> boxes) {
  assert(bvh.refs.size() == boxes.size());
  for (std::size_t i = bvh.nodes.size(); i-- > 0;) {
    BvhNode& node = bvh.nodes[i];
    Aabb box;
    if (node.is_leaf()) {
      for (std::uint32_t r = 0; r < node.count; ++r) box.extend(boxes[bvh.refs[node.first + r]]);
    } else {
      box = bvh.nodes[node.first].box();
      box.extend(bvh.nodes[node.first + 1].box());
    }
    node.set_box(box);
  }
}

double sah_cost(const Bvh& bvh, const BvhBuildConfig& config) {
  if (bvh.nodes.empty()) return 0;
  const auto area = [](const BvhNode& node) {
    const Vec3d e = to_double(node.hi) - to_double(node.lo);
    return 2 * (e.x * e.y + e.y * e.z + e.z * e.x);
  };
  const double root_area = area(bvh.nodes[0]);
  double cost = 0;
  for (const BvhNode& node : bvh.nodes) {
    const double visit =
        node.is_leaf()
            ? static_cast<double>(config.intersect_cost * block_tests(node.count, config.block))
            : static_cast<double>(config.traversal_cost);
    // A root without area is met as a whole or not at all.
    cost += root_area > 0 ? visit * area(node) / root_area : visit;
  }
  return cost;
}

}  // namespace mdk
