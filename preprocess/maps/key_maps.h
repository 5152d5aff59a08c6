// The maps of the finished decomposition, every cluster at every key: towards small boxes, as in
// GFW06, or those of bones.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "common/math/affine3.h"
#include "common/motion/pose_sequence.h"
#include "preprocess/decomposition.h"
#include "preprocess/options.h"
#include "preprocess/pose/pose_table.h"

namespace mdk {

/// What maps are fitted for.
struct KeyMapRequest {
  std::uint32_t rest_key = 0;
  double unit = 1;  ///< see pose_unit
  bool refine = true;
  BetweenKeys between = BetweenKeys::kBound;  ///< at which times boxes are compared
};

/// Maps towards small boxes, cluster by cluster at all keys: least squares, the rotation that suits
/// the boxes best, then refinement, kept where it makes the boxes of all times smaller. `report`
/// receives the share of the work done. Cost: O(keys * vertices).
KeyMaps fit_small_boxes(const PoseSequence& sequence, const ClusterMembers& members,
                        const KeyMapRequest& request, const std::function<void(double)>& report);

/// The paper's maps: each key fitted to the rest pose by least squares, block by block, so that
/// memory stays small beside the sequence. `local_from_rest`: K, see LocalFrames.
/// Cost: O(keys * vertices).
KeyMaps fit_key_maps(const PoseSequence& sequence, const ClusterMembers& members,
                     const KeyMapRequest& request, std::span<const Affine3d> local_from_rest);

/// Identity maps for every key: local boxes are world boxes.
KeyMaps identity_key_maps(const PoseSequence& sequence, const ClusterMembers& members,
                          std::uint32_t rest_key);

/// The bone's inverse at each of `keys`. Where a bone is flat or a point it has none: the linear
/// part of the nearest key before that has one (or the first after) goes on with the bone's origin.
std::vector<Affine3d> base_from_world(const Rig& rig, std::uint32_t bone,
                                      std::span<const std::uint32_t> keys, std::uint32_t key_count);

/// The same for the rows of a table, from table coordinates, in table units on both sides.
std::vector<Affine3d> base_from_table(const Rig& rig, std::uint32_t bone, const PoseTable& table,
                                      std::uint32_t key_count);

/// A basis for each cluster, from its bone's base space: turned so that its triangles' boxes over
/// the table's keys are small (maps/local_frame.h). `bones`: K.
std::vector<ClusterBone> choose_bone_bases(const PoseSequence& sequence, const PoseTable& table,
                                           const ClusterMembers& members,
                                           std::span<const std::uint32_t> bones);

/// local_from_base * bone⁻¹ at every key. Residuals are distances to the position at `rest_key`.
KeyMaps bone_key_maps(const PoseSequence& sequence, const ClusterMembers& members,
                      std::span<const ClusterBone> bones, std::uint32_t rest_key);

/// Residuals of any maps: local positions taken back to the world by the cluster's map at the rest
/// key, and compared with the rest pose. Cost: O(keys * vertices).
ResidualStats residual_stats(const PoseSequence& sequence, const ClusterMembers& members,
                             std::span<const Affine3f> local_from_world, std::uint32_t rest_key);

}  // namespace mdk
