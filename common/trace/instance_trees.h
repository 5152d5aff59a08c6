// InstanceTrees: hierarchies over a scene's instances that hold at every time. Those that stand
// still are in one tree over the boxes of their whole clips: it never changes. Those on paths are
// in a tree for each of some stretches of the scene's clock, over the boxes of that stretch.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/scene/scene.h"
#include "common/structures/wide_bvh.h"

namespace mdk {

class InstanceTrees {
 public:
  /// Cost: O(N log N), and for each moving one its box in every stretch; runs in parallel. Memory:
  /// some 50 bytes for each standing instance, and for each moving one in each stretch.
  explicit InstanceTrees(const Stage& stage);

  /// Leaves are instances, each in one leaf of the trees that a ray of this time goes through.
  std::span<const WideBvhNode> standing() const { return standing_; }
  std::span<const WideBvhNode> moving(double time) const {
    return moving_.empty() ? std::span<const WideBvhNode>() : moving_[stretch_of(time)];
  }

  /// Holds all of it at all times; empty for an empty scene.
  const Aabb& bounds() const { return bounds_; }
  /// The largest of all instances.
  double unevenness() const { return unevenness_; }

  std::size_t stretch_count() const { return moving_.size(); }
  std::size_t bytes() const;

 private:
  std::size_t stretch_of(double time) const;

  std::vector<WideBvhNode> standing_;
  std::vector<std::vector<WideBvhNode>> moving_;  ///< before the first path, stretches, after all
  double first_time_ = 0, stretch_seconds_ = 1;
  Aabb bounds_;
  double unevenness_ = 1;
};

}  // namespace mdk
