// What a user may choose about a decomposition, and whether that fits together and fits the
// animation. Everything else in this room is decided by the cost (docs/method.md).
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "common/motion/pose_sequence.h"

namespace mdk {

enum class DecomposeMode {
  kMotion,  ///< clusters of triangles that move alike (GFW06 §3.1)
  kBones,   ///< a cluster for each bone of the rig (preprocess/cluster/boxes/bone_clusters.h)
  kNone,    ///< a cluster for each mesh, with identity maps: fuzzy boxes in world space
};

/// The poses that the boxes of bones hold for.
enum class PoseSampling {
  kCycle,      ///< those of the clips
  kPoseSpace,  ///< and each in which no joint is turned past its limit
};

/// Whether the curves between keys are looked at.
enum class BetweenKeys {
  kBound,   ///< boxes hold at every time
  kIgnore,  ///< boxes hold at keys only, as in GFW06; the model says so
};

/// What the clusters of mode kMotion should be like.
struct ClusterRequest {
  std::uint32_t clusters = 0;            ///< exactly so many; 0: as many as pay
  std::optional<double> stop_percent{};  ///< GFW06's rule: stop when a cluster lowers the residual
                                         ///< by less than this; without it the cost decides
  std::optional<std::uint32_t> rest_key{};  ///< fixed rest pose; none: searched
};

/// The one that is requested, or none.
inline std::span<const std::uint32_t> requested_rest_keys(const ClusterRequest& request) {
  return request.rest_key ? std::span(&*request.rest_key, 1) : std::span<const std::uint32_t>();
}

struct DecomposeOptions : ClusterRequest {
  DecomposeMode mode = DecomposeMode::kMotion;
  PoseSampling sampling = PoseSampling::kCycle;  ///< with kBones only
  double joint_limit_degrees = 90;               ///< with kPoseSpace only; in [0, 180]
  std::uint32_t segments = 0;  ///< exactly so many, or as many as there can be; 0: as many as
                               ///< pay
  BetweenKeys between = BetweenKeys::kBound;
  bool refine = true;              ///< improve maps towards the smallest boxes
  std::optional<double> quantize;  ///< key positions may be so far off, in rest pose diagonals, to
                                   ///< take less room; a rig that takes less still stays exact
};

inline constexpr std::uint32_t kMaxClusters = 1024;

/// Throws Error where these options cannot be met for this sequence: kUsage where they contradict
/// each other or ask for what does not exist, kBadInput where the sequence lacks what they need or
/// has nothing to decompose.
void validate(const DecomposeOptions& options, const PoseSequence& sequence);

}  // namespace mdk
