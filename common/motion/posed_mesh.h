// PosedMesh: a model's vertices and clusters at one moment, or as its skeleton is posed by hand.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/motion/model.h"

namespace mdk {

/// The pose of `model` at an interval: v0 + s (v1 - v0) of two decoded key poses, in float, per
/// coordinate. The last two key poses stay decoded, so that playing decodes each key once. Where
/// the model holds key positions, they are used in place.
class PosedMesh {
 public:
  explicit PosedMesh(const Model& model) : model_(&model) {}

  /// Moves to another moment. Cost: O(vertices) between keys, and for each key that is not at hand,
  /// decoding it. Runs in parallel.
  void set_time(const KeyInterval& at);

  /// Poses the skeleton, until the next set_time(). Boxes hold where no joint is past its limit
  /// (joint_past_limit) and morph weights stay between the least and the largest of the keys.
  /// Throws Error (kUsage) where the model has no skeleton, or another than the pose. Cost:
  /// O(vertices + triangles). Runs in parallel.
  void set_pose(const SkeletonPose& pose);

  const Model& model() const { return *model_; }
  /// The last moment; what is_live() is not at a moment.
  const KeyInterval& at() const { return at_; }
  bool is_live() const { return !live_clusters_.empty(); }
  std::span<const Vec3f> positions() const { return positions_; }

  /// local_from_world of cluster `c` now.
  Affine3d cluster_map(std::uint32_t c) const;
  /// World box of cluster `c` now: holds all its vertices.
  Aabb cluster_box(std::uint32_t c) const;

 private:
  struct DecodedKey {
    std::optional<std::uint32_t> key;
    std::vector<Vec3f> positions;
  };

  struct LiveCluster {
    Affine3d local_from_world;
    Aabb box;
  };

  /// The pose at a key; what `kept` names stays decoded.
  std::span<const Vec3f> key_pose(std::uint32_t key, std::uint32_t kept);

  const Model* model_;
  KeyInterval at_;
  std::span<const Vec3f> positions_;
  DecodedKey decoded_[2];
  std::vector<Vec3f> between_;
  std::vector<LiveCluster> live_clusters_;  ///< K while posed by hand, else none
};

/// World box of cluster `c` at a moment: holds all its vertices. Linear between keys, which bounds
/// linearly moving vertices (docs/method.md, time between keys).
Aabb cluster_world_box(const Model& model, std::uint32_t c, const KeyInterval& at);

/// Boxes of all triangles in the present pose, in triangle order; `boxes` has one per triangle.
/// None is empty or infinite: a triangle with a corner that is not finite cannot be hit
/// (docs/kernels.md), and gets a point. Runs in parallel.
void triangle_boxes(const PosedMesh& mesh, std::span<Aabb> boxes);

}  // namespace mdk
