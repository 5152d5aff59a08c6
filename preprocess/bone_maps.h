// Bases, maps and boxes of clusters that follow bones (preprocess/bone_clusters.h).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/motion/model.h"
#include "common/motion/pose_sequence.h"
#include "preprocess/cluster_members.h"
#include "preprocess/key_maps.h"
#include "preprocess/pose_space.h"
#include "preprocess/pose_table.h"

namespace mdk {

/// A basis for each cluster, from its bone's base space: turned so that its triangles' boxes over
/// the table's keys are small (preprocess/local_frame.h). `bones`: K.
std::vector<ClusterBone> choose_bone_bases(const PoseSequence& sequence, const PoseTable& table,
                                           const ClusterMembers& members,
                                           std::span<const std::uint32_t> bones);

/// local_from_base * bone⁻¹ at every key. Residuals are distances to the position at `rest_key`.
KeyMaps bone_key_maps(const PoseSequence& sequence, const ClusterMembers& members,
                      std::span<const ClusterBone> bones, std::uint32_t rest_key);

/// Per triangle, in the order of `members.triangles`: a box that holds it in every pose of the
/// space, in its cluster's basis. Throws Error (kBadInput) where a bone that must be inverted is
/// flat.
std::vector<Aabb> pose_space_boxes(const PoseSpace& space, const ClusterMembers& members,
                                   std::span<const ClusterBone> bones);

}  // namespace mdk
