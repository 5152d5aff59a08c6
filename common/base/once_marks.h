// OnceMarks: which of some jobs have been done in the present round, each by the thread that first
// asks for it. A mark is the number of the round it was set in, so that a new round clears nothing.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <thread>

namespace mdk {

class OnceMarks {
 public:
  /// Begins a round: none of `count` jobs is done. Not while other threads ask.
  void begin(std::size_t count) {
    done_ += 2;
    const bool wrapped = done_ < 2;
    if (count > size_ || wrapped) {
      size_ = count > size_ ? count : size_;
      marks_ = std::make_unique<std::atomic<std::uint32_t>[]>(size_);
      done_ = 2;
    }
  }

  bool is_done(std::size_t job) const {
    return marks_[job].load(std::memory_order_acquire) == done_;
  }
  void set_done(std::size_t job) { marks_[job].store(done_, std::memory_order_release); }

  /// Does the job unless it is done; afterwards it is. Waits where another thread is at it: only
  /// for short jobs, which must not throw.
  template <class Work>
  void once(std::size_t job, const Work& work) {
    std::uint32_t seen = marks_[job].load(std::memory_order_acquire);
    if (seen == done_) return;
    const std::uint32_t busy = done_ - 1;
    if (seen != busy &&
        marks_[job].compare_exchange_strong(seen, busy, std::memory_order_relaxed)) {
      work();
      set_done(job);
    } else {
      while (!is_done(job)) std::this_thread::yield();
    }
  }

 private:
  std::size_t size_ = 0;
  std::uint32_t done_ = 0;  ///< what a job's mark is once done in this round; one less: under way
  std::unique_ptr<std::atomic<std::uint32_t>[]> marks_;
};

}  // namespace mdk
