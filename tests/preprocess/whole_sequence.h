// A sequence, or a model made of one, as the stages of a decomposition want it: all keys, one
// cluster.
#pragma once

#include <cstdint>
#include <numeric>
#include <vector>

#include "common/motion/model.h"
#include "common/motion/pose_sequence.h"
#include "preprocess/boxes/fuzzy_boxes.h"
#include "preprocess/decomposition.h"
#include "preprocess/pose/pose_table.h"

namespace mdk {

inline std::vector<std::uint32_t> all_keys(const PoseSequence& sequence) {
  std::vector<std::uint32_t> keys(sequence.key_count());
  std::iota(keys.begin(), keys.end(), 0u);
  return keys;
}

inline PoseTable whole_table(const PoseSequence& sequence) {
  return make_pose_table(sequence, all_keys(sequence), pose_unit(sequence));
}

/// All triangles in one cluster.
inline ClusterMembers whole_members(const PoseSequence& sequence) {
  return make_cluster_members(sequence.triangles, one_cluster(sequence.triangles.size()),
                              sequence.vertex_count);
}

/// Boxes of a model that keeps key positions over its keys only, in triangle order.
inline std::vector<Aabb> boxes_over_keys_only(const ModelStorage& model) {
  PoseSequence sequence;
  sequence.vertex_count = model.vertex_count;
  sequence.triangles = model.triangles;
  sequence.clips = model.clips;
  sequence.key_times = model.key_times;
  sequence.positions = model.poses.key_positions;
  std::vector<std::uint32_t> cluster_of_triangle;
  for (std::uint32_t c = 0; c < model.clusters.size(); ++c)
    cluster_of_triangle.resize(cluster_of_triangle.size() + model.clusters[c].triangle_count, c);
  return fuzzy_boxes(
      sequence,
      make_cluster_members(model.triangles, make_assignment(std::move(cluster_of_triangle)),
                           model.vertex_count),
      model.local_from_world, model.segments[0], BetweenKeys::kIgnore);
}

}  // namespace mdk
