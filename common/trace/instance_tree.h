// InstanceTree: the hierarchy over the boxes of a scene's instances. Where an instance stands still
// its box holds at all times of its clip, so that nothing changes from frame to frame; boxes of
// those on paths follow them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/scene/scene.h"
#include "common/structures/wide_bvh.h"

namespace mdk {

class InstanceTree {
 public:
  /// Runs in parallel. Cost: O(N log N). The stage must outlive it.
  InstanceTree(const Stage& stage, double time);

  /// Makes it valid at a time. Cost: O(N) where some instances move, else none. Runs in parallel.
  void update(double time);

  std::span<const WideBvhNode> nodes() const { return nodes_; }
  const std::uint32_t* instance_of_leaf() const { return instance_of_leaf_.data(); }
  /// The largest of all instances.
  double unevenness() const { return unevenness_; }
  std::size_t bytes() const {
    return nodes_.size() * sizeof(WideBvhNode) +
           (instance_of_leaf_.size() + moving_nodes_.size()) * sizeof(std::uint32_t);
  }

 private:
  Aabb box(std::uint32_t instance, double time) const;

  const Stage* stage_;
  double time_;
  double unevenness_ = 1;
  std::vector<WideBvhNode> nodes_;  ///< children after their parents
  std::vector<std::uint32_t> instance_of_leaf_;
  std::vector<std::uint32_t> moving_nodes_;  ///< that hold an instance on a path, ascending
};

}  // namespace mdk
