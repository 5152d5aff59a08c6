// PosedMesh: a model's vertices at one moment.
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

  const Model& model() const { return *model_; }
  const KeyInterval& at() const { return at_; }
  std::span<const Vec3f> positions() const { return positions_; }

 private:
  struct DecodedKey {
    std::optional<std::uint32_t> key;
    std::vector<Vec3f> positions;
  };

  /// The pose at a key; what `kept` names stays decoded.
  std::span<const Vec3f> key_pose(std::uint32_t key, std::uint32_t kept);

  const Model* model_;
  KeyInterval at_;
  std::span<const Vec3f> positions_;
  DecodedKey decoded_[2];
  std::vector<Vec3f> between_;
};

/// World box of cluster `c` at a moment: holds all its vertices. Linear between keys, which bounds
/// linearly moving vertices (docs/method.md, time between keys).
Aabb cluster_world_box(const Model& model, std::uint32_t c, const KeyInterval& at);

/// Boxes of all triangles in the present pose, in triangle order; `boxes` has one per triangle.
/// None is empty or infinite: a triangle with a corner that is not finite cannot be hit
/// (docs/kernels.md), and gets a point. Runs in parallel.
void triangle_boxes(const PosedMesh& mesh, std::span<Aabb> boxes);

}  // namespace mdk
