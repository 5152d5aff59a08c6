// WorldTree: one hierarchy over all triangles of a model, in the world, that is refitted to a
// moment.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/motion/model.h"
#include "common/trace/kernels/ray_kernels.h"

namespace mdk {

/// Which triangles stand together, as they lie at one time.
class WorldTree {
 public:
  /// Vertex v of the model stands at place_of_vertex[v] of the source. Runs in parallel. Cost: O(T
  /// log T).
  WorldTree(const ModelView& model, const std::vector<std::uint32_t>& place_of_vertex,
            const VertexSource& source);

  const std::vector<RayNode>& nodes() const { return nodes_; }
  const std::vector<RayBlock>& blocks() const { return blocks_; }
  std::size_t bytes() const {
    return nodes_.size() * sizeof(RayNode) + blocks_.size() * sizeof(RayBlock);
  }

 private:
  std::vector<RayNode> nodes_;  ///< links of leaves are numbers of blocks
  std::vector<RayBlock> blocks_;
};

/// The same with the boxes of another time, and the vertices there.
class PosedWorldTree {
 public:
  /// The tree must outlive it. Cost: O(T).
  PosedWorldTree(const WorldTree& tree, const VertexSource& source);

  const PosedScene& scene() const { return scene_; }
  std::size_t bytes() const {
    return nodes_.size() * sizeof(RayNode) + posed_.size() * sizeof(PosedRayBlock);
  }

 private:
  std::vector<RayNode> nodes_;
  std::vector<PosedRayBlock> posed_;
  PosedScene scene_;
};

}  // namespace mdk
