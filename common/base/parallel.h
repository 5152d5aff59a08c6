// Long work: loops over oneTBB in fixed chunks, how they are limited and stopped, and how the work
// tells whoever started it how far it is. Which thread runs a chunk never changes a result: a chunk
// writes its own outputs, and sums are taken in chunk order afterwards by the caller. Nothing here
// holds for the whole process: limits and checks belong to the thread that made them, and to the
// loops that it starts.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string_view>
#include <thread>

namespace mdk {

/// Limits the threads of the parallel loops that its own thread starts while it lives, and of the
/// loops inside of those; 0 means all cores. Of nested limits the smallest one counts. A thread
/// that is started meanwhile has no limit: hand it thread_count() for one of its own.
class ThreadLimit {
 public:
  explicit ThreadLimit(int threads);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  struct Scope;
  std::unique_ptr<Scope> scope_;
};

/// While it lives, the parallel loops of the thread that made it, and the loops inside of those,
/// call `check` before each chunk, on any of their threads; what `check` throws ends the loop. So
/// long work can be told to stop. Of nested ones the innermost counts.
class LoopCheck {
 public:
  explicit LoopCheck(std::function<void()> check);
  ~LoopCheck();
  LoopCheck(const LoopCheck&) = delete;
  LoopCheck& operator=(const LoopCheck&) = delete;

 private:
  std::function<void()> check_;
  const std::function<void()>* outer_;
};

/// Calls the check there is, for long work outside of parallel loops.
void check_loop();

/// How many threads a parallel loop of this thread may use now.
int thread_count();

/// Calls body(begin, end) for [0, n) cut into chunks of `grain`, in any order and on any thread.
/// An exception from a body ends the loop and is passed on.
void parallel_chunks(std::size_t n, std::size_t grain,
                     const std::function<void(std::size_t begin, std::size_t end)>& body);

/// Which of some jobs have been done in the current round, each by the thread that first asks for
/// it. A mark is the number of the round it was set in, so that a new round clears nothing.
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

/// How long work reports how far it is, and is told to stop.
class ProgressSink {
 public:
  virtual ~ProgressSink() = default;
  /// `fraction` in [0, 1] of the whole job; `stage` as shown to people ("decompose"). Called from
  /// one thread at a time. To cancel the job, throw from here.
  virtual void report(std::string_view stage, double fraction) = 0;
};

/// Ignores all reports.
class SilentProgress final : public ProgressSink {
 public:
  void report(std::string_view, double) override {}
};

/// A part of a longer job: its 0 and 1 are `from` and `to` of the whole. The whole must outlive it.
class ProgressPart final : public ProgressSink {
 public:
  ProgressPart(ProgressSink& whole, double from, double to) : whole_(whole), from_(from), to_(to) {}
  void report(std::string_view stage, double fraction) override {
    whole_.report(stage, from_ + (to_ - from_) * fraction);
  }

 private:
  ProgressSink& whole_;
  double from_, to_;
};

}  // namespace mdk
