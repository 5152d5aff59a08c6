// Pose: the moment a picture shows, from a clip or posed by hand, and where things are in it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/motion/model.h"
#include "common/motion/posed_mesh.h"
#include "common/motion/rig.h"

namespace mdk {

struct Moment {
  KeyInterval at;
  std::optional<SkeletonPose> pose;  ///< posed by hand: counts instead of `at`

  bool operator==(const Moment&) const = default;
};

/// The mesh as it is at the moment. Cost: as PosedMesh.
PosedMesh mesh_at(const ModelView& model, const Moment& moment);

struct ClusterPlaces {
  std::vector<Affine3d> local_from_world;  ///< K
  std::vector<Aabb> world_boxes;           ///< K
};

/// Cost: O(clusters); O(vertices + triangles) for a pose by hand.
ClusterPlaces cluster_places(const ModelView& model, const Moment& moment);

/// The corners of a triangle, as mesh_at() has them. Cost: three vertices; O(vertices + triangles)
/// for a pose by hand.
std::array<Vec3d, 3> corners_at(const ModelView& model, const Moment& moment,
                                std::uint32_t triangle);

/// The time segment whose boxes hold.
std::uint32_t segment_of(const ModelView& model, const Moment& moment);

/// A skeleton posed by hand instead of by a clip, and whether the boxes still hold there.
struct HandPose {
  bool active = false;         ///< it is what is shown
  bool beyond_limits = false;  ///< joints may be turned past what the boxes were made for
  std::uint32_t joint = 0;     ///< the chosen one
  SkeletonPose pose;
};

/// At rest, with the morph weights of the first key, the first joint chosen that can turn.
/// Inactive.
HandPose rest_pose_of(const ModelView& model);

/// Range of each morph weight over the clips, which the boxes hold for.
struct WeightRange {
  float min = 0, max = 0;
};
std::vector<WeightRange> weight_ranges(const ModelView& model);

/// Turns the chosen joint by the rotation vector `turn` (radians, in its own axes), shortened to
/// its limit unless it may go beyond.
void turn_joint(HandPose& hand, const SkeletonView& skeleton, const Vec3d& turn);

/// The name of a joint, or "joint 7" where it has none.
std::string joint_name(const SkeletonView& skeleton, std::uint32_t joint);

}  // namespace mdk
