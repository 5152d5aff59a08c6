// FrameCache: blocks that every thread may need in a frame, each made by the thread that first
// asks.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>

namespace mdk {

/// `MostBlocks`: past so many, fetching what was kept would cost as much as making it again.
template <class Block, std::size_t MostBlocks>
class FrameCache {
 public:
  /// Begins a frame with so many blocks: none is made.
  void begin_frame(std::size_t blocks) {
    usable_ = blocks <= MostBlocks;
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

}  // namespace mdk
