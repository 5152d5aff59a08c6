// The triangles of a leaf, sixteen side by side, and what a frame makes of them for its rays:
// how they look from the eye, and where their corners are. All rays of a frame share both, so a
// block is worked out once per frame, by the first thread that comes to it.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "common/motion/pose_sequence.h"
#include "common/structures/wide_bvh.h"

namespace mdk {

inline constexpr std::uint32_t kBlockTriangles = kLeafItems;

/// Triangles and where their corners stand among the positions. Unused lanes repeat lane 0.
struct alignas(64) TriangleBlock {
  std::uint32_t corner[3][kBlockTriangles];
  std::uint32_t triangle[kBlockTriangles];
  std::uint32_t count = 0;

  /// Lane `count` becomes `number`; `t` is that triangle.
  void push(std::uint32_t number, const Triangle& t) {
    for (int k = 0; k < 3; ++k) corner[k][count] = t.v[k];
    triangle[count++] = number;
  }
  /// To be called once after the last push().
  void pad() {
    for (std::uint32_t i = count; i < kBlockTriangles; ++i) {
      for (auto& row : corner) row[i] = row[0];
      triangle[i] = triangle[0];
    }
  }
};

/// Collects single triangles into blocks for test(block).
template <class Test>
class TriangleBatch {
 public:
  TriangleBatch(const Triangle* triangles, const Test& test) : triangles_(triangles), test_(test) {}

  void push(std::uint32_t triangle) {
    block_.push(triangle, triangles_[triangle]);
    if (block_.count == kBlockTriangles) flush();
  }
  void flush() {
    if (block_.count == 0) return;
    block_.pad();
    test_(block_);
    block_.count = 0;
  }

 private:
  const Triangle* triangles_;
  const Test& test_;
  TriangleBlock block_;
};

/// A linear form over the image, one per triangle: x X + (y Y + z).
struct alignas(64) ImageForms {
  float x[kBlockTriangles], y[kBlockTriangles], z[kBlockTriangles];
};

/// A block in the image (docs/kernels.md, "The triangle test").
struct alignas(64) ProjectedBlock {
  ImageForms edge[3];
  ImageForms inverse_depth;
  /// Of the deepest and of the nearest corner; infinite where one is behind the eye.
  alignas(64) float min_inverse_depth[kBlockTriangles];
  alignas(64) float max_inverse_depth[kBlockTriangles];
  /// First and last pixel centres a hit may be at: those within the corners' bounds and
  /// a margin (PixelFromWorld). Without end where a corner is behind the eye.
  alignas(64) float first_x[kBlockTriangles];
  alignas(64) float last_x[kBlockTriangles];
  alignas(64) float first_y[kBlockTriangles];
  alignas(64) float last_y[kBlockTriangles];
  // One bit per triangle.
  std::uint32_t live = 0;    ///< may be hit at all
  std::uint32_t behind = 0;  ///< has a corner behind the eye
  std::uint32_t small = 0;   ///< may be hit in at most 2 x 2 pixels
};

/// The corners of a block's triangles, side by side.
struct alignas(64) PosedBlock {
  float x[3][kBlockTriangles], y[3][kBlockTriangles], z[3][kBlockTriangles];
};

/// What a frame has made of its blocks. `kMaxBlocks`: past so many, fetching what was kept would
/// cost as much as making it again.
template <class Block, std::size_t kMaxBlocks>
class FrameCache {
 public:
  /// Begins a frame with so many blocks: none is made.
  void begin_frame(std::size_t blocks) {
    usable_ = blocks <= kMaxBlocks;
    if (!usable_) return;
    ready_ += 2;
    const bool wrapped = ready_ < 2;
    if (blocks > size_ || wrapped) {
      size_ = std::max(size_, blocks);
      blocks_.reset(new Block[size_]);  // not cleared: a block is written before it is read
      states_ = std::make_unique<std::atomic<std::uint32_t>[]>(size_);
      ready_ = 2;
    }
  }

  /// Whether the frame has few enough blocks.
  bool usable() const { return usable_; }

  /// Block `number`, made by make(block) if this frame has not seen it. Never waits: where another
  /// thread is at it, `spare` is filled and returned instead.
  template <class Make>
  const Block& get(std::uint32_t number, Block& spare, const Make& make) {
    std::atomic<std::uint32_t>& state = states_[number];
    std::uint32_t seen = state.load(std::memory_order_acquire);
    if (seen == ready_) return blocks_[number];
    const std::uint32_t busy = ready_ - 1;
    if (seen != busy && state.compare_exchange_strong(seen, busy, std::memory_order_relaxed)) {
      make(blocks_[number]);
      state.store(ready_, std::memory_order_release);
      return blocks_[number];
    }
    make(spare);
    return spare;
  }

  std::size_t bytes() const { return size_ * (sizeof(Block) + sizeof(std::uint32_t)); }

 private:
  std::size_t size_ = 0;
  bool usable_ = false;
  std::uint32_t ready_ = 0;  ///< what a block's state is once made in this frame
  std::unique_ptr<Block[]> blocks_;
  std::unique_ptr<std::atomic<std::uint32_t>[]> states_;
};

using ProjectionCache = FrameCache<ProjectedBlock, 32768>;
using PosedBlockCache = FrameCache<PosedBlock, 1 << 18>;

}  // namespace mdk
