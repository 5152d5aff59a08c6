// WorldTree: one hierarchy over all triangles of a model, in the world, that is refitted to a moment.
#pragma once

#include <cstddef>
#include <vector>

#include "common/motion/model.h"
#include "common/trace/kernels/ray_kernels.h"

namespace mdk {

/// Which triangles stand together, as they lie at one time.
class WorldTree {
 public:
  /// Runs in parallel. Cost: O(T log T).
  WorldTree(const ModelView& model, const VertexSource& source);

  const std::vector<WideBvhNode>& nodes() const { return nodes_; }
  const std::vector<RayBlock>& blocks() const { return blocks_; }
  std::size_t bytes() const {
    return nodes_.size() * sizeof(WideBvhNode) + blocks_.size() * sizeof(RayBlock);
  }

 private:
  std::vector<WideBvhNode> nodes_;  ///< links of leaves are numbers of blocks
  std::vector<RayBlock> blocks_;
};

/// The same with the boxes of another time, and the vertices there.
class PosedWorldTree {
 public:
  /// The tree must outlive it. Cost: O(T).
  PosedWorldTree(const WorldTree& tree, const VertexSource& source);

  const PosedScene& scene() const { return scene_; }
  std::size_t bytes() const {
    return nodes_.size() * sizeof(WideBvhNode) + posed_.size() * sizeof(PosedRayBlock);
  }

 private:
  std::vector<WideBvhNode> nodes_;
  std::vector<PosedRayBlock> posed_;
  PosedScene scene_;
};

}  // namespace mdk
