#include "common/trace/kernels/triangle_block.h"

namespace mdk {

void append_blocks(const WideBvh& bvh, std::span<const Triangle> triangles, std::uint32_t first,
                   std::vector<TriangleBlock>& blocks) {
  for (std::uint32_t leaf = 0; leaf < bvh.leaf_count(); ++leaf) {
    TriangleBlock& block = blocks.emplace_back();
    for (const std::uint32_t item : bvh.leaf(leaf)) {
      if (item == kNoItem) break;
      block.push(first + item, triangles[first + item]);
    }
    block.pad();
  }
}

}  // namespace mdk
