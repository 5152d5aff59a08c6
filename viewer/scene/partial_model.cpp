#include "viewer/scene/partial_model.h"

namespace mdk {

PartialModel::PartialModel(const Model& whole, std::span<const std::uint8_t> left_out)
    : model_(whole),
      triangles_(whole.triangles.begin(), whole.triangles.end()),
      world_boxes_(whole.cluster_world_boxes.begin(), whole.cluster_world_boxes.end()) {
  const std::uint32_t clusters = whole.cluster_count();
  for (std::uint32_t c = 0; c < clusters; ++c) {
    if (left_out[c] == 0) continue;
    const Cluster& cluster = whole.clusters[c];
    for (std::uint32_t t = 0; t < cluster.triangle_count; ++t) {
      Triangle& triangle = triangles_[cluster.first_triangle + t];
      triangle.v[1] = triangle.v[2] = triangle.v[0];
    }
    for (std::size_t box = c; box < world_boxes_.size(); box += clusters)
      world_boxes_[box].hi = world_boxes_[box].lo;
  }
  model_.triangles = triangles_;
  model_.cluster_world_boxes = world_boxes_;
}

}  // namespace mdk
