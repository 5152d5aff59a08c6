// Parallel loops over oneTBB in fixed chunks. Which thread runs a chunk never changes a result: a
// chunk writes its own outputs, and sums are taken in chunk order afterwards by the caller.
#pragma once

#include <cstddef>
#include <functional>

namespace mdk {

/// Limits the threads of every parallel loop while it lives; 0 means all cores. Nested limits: the
/// smallest one wins.
class ThreadLimit {
 public:
  explicit ThreadLimit(int threads);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  void* control_;
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

/// How many threads a parallel loop may use now.
int thread_count();

/// Calls body(begin, end) for [0, n) cut into chunks of `grain`, in any order and on any thread.
/// An exception from a body ends the loop and is passed on.
void parallel_chunks(std::size_t n, std::size_t grain,
                     const std::function<void(std::size_t begin, std::size_t end)>& body);

}  // namespace mdk
