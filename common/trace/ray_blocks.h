// RaySegment: the fuzzy hierarchies of one time segment and the triangles of their leaves, as
// single rays take them: valid at all times of the segment (Lo09 §4.3).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/motion/model.h"
#include "common/trace/kernels/ray_kernels.h"

namespace mdk {

class RaySegment {
 public:
  /// Runs in parallel. Cost: O(T log T). The result depends on the model alone.
  RaySegment(const ModelView& model, std::uint32_t segment);

  /// By cluster; valid while this lives, also where it is moved to.
  std::span<const RayTree> trees() const { return trees_; }
  std::size_t bytes() const;

  /// Calls visit(a block's vertex number, which may be changed) for all, block by block.
  template <class Visit>
  void for_each_vertex(const Visit& visit) {
    for (std::vector<RayBlock>& blocks : blocks_)
      for (RayBlock& block : blocks)
        for (std::uint32_t& vertex : block.vertex) visit(vertex);
  }

 private:
  std::vector<std::vector<RayNode>> nodes_;    ///< by cluster
  std::vector<std::vector<RayBlock>> blocks_;  ///< by cluster
  std::vector<RayTree> trees_;
};

/// A hierarchy over the boxes of triangles, which count from `first`; the links of its leaves are
/// numbers of blocks, which are appended to `blocks`. Node 0 is the root; children have higher
/// indices than their parents. Runs in parallel. Cost: O(N log N).
std::vector<RayNode> build_ray_tree(std::span<const Aabb> boxes, int bins, std::uint32_t first,
                                    std::span<const Triangle> triangles,
                                    std::vector<RayBlock>& blocks);

/// Appends a leaf's triangles to `blocks`: as few blocks as hold them in order, each of at most
/// kBlockVertices vertices.
void append_ray_blocks(std::span<const std::uint32_t> triangles, std::span<const Triangle> all,
                       std::vector<RayBlock>& blocks);

}  // namespace mdk
