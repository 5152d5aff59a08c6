#include "common/trace/kernels/triangle_block.h"

namespace mdk {
namespace {

constexpr std::size_t kMostBlocks = 32768;

}  // namespace

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

void ProjectionCache::begin_frame(std::size_t blocks) {
  usable_ = blocks <= kMostBlocks;
  if (!usable_) return;
  ready_ += 2;
  const bool wrapped = ready_ < 2;
  if (blocks > size_ || wrapped) {
    size_ = std::max(size_, blocks);
    blocks_.reset(new ProjectedBlock[size_]);  // not cleared: a block is written before it is read
    states_ = std::make_unique<std::atomic<std::uint32_t>[]>(size_);
    ready_ = 2;
  }
}

}  // namespace mdk
