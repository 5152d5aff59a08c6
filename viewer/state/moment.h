// Moment: the pose a picture shows, and where the clusters' bases and boxes are in it.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "common/motion/posed_mesh.h"

namespace mdk {

struct Moment {
  KeyInterval at;
  std::optional<SkeletonPose> pose;  ///< posed by hand: counts instead of `at`

  bool operator==(const Moment&) const = default;
};

/// The mesh as it is at the moment. Cost: as PosedMesh.
PosedMesh mesh_at(const Model& model, const Moment& moment);

struct ClusterPlaces {
  std::vector<Affine3d> local_from_world;  ///< K
  std::vector<Aabb> world_boxes;           ///< K
};

/// Cost: O(clusters); O(vertices + triangles) for a pose by hand.
ClusterPlaces cluster_places(const Model& model, const Moment& moment);

/// The corners of a triangle, as mesh_at() has them. Cost: three vertices; O(vertices + triangles)
/// for a pose by hand.
std::array<Vec3d, 3> corners_at(const Model& model, const Moment& moment, std::uint32_t triangle);

/// The time segment whose boxes hold.
std::uint32_t segment_of(const Model& model, const Moment& moment);

}  // namespace mdk
