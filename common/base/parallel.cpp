// What a thread's loops go by lies with the thread, since loops are too deep to hand it down to
// each. Threads that help with a loop take over what its own thread has, while they do. A limit has
// an arena, oneTBB's name for a group of threads with so many places.
#include "common/base/parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <optional>
#include <utility>

namespace mdk {
namespace {

struct LoopContext {
  const std::function<void()>* check = nullptr;
  int max_threads = 0;               ///< 0: all cores
  tbb::task_arena* arena = nullptr;  ///< where the next loop runs; null within it, and without
};
thread_local LoopContext context;

/// What a chunk's thread goes by, until the chunk is done.
class ChunkContext {
 public:
  explicit ChunkContext(const LoopContext& of_loop)
      : own_(std::exchange(context, {of_loop.check, of_loop.max_threads, nullptr})) {}
  ~ChunkContext() { context = own_; }
  ChunkContext(const ChunkContext&) = delete;
  ChunkContext& operator=(const ChunkContext&) = delete;

 private:
  LoopContext own_;
};

}  // namespace

struct ThreadLimit::Scope {
  explicit Scope(int threads) : outer(context) {
    if (threads <= 0 || (outer.max_threads > 0 && outer.max_threads <= threads)) return;
    context.max_threads = threads;
    const int places = std::min(threads, tbb::info::default_concurrency());  // more only warn
    context.arena = places > 1 ? &arena.emplace(places) : nullptr;
  }

  LoopContext outer;
  std::optional<tbb::task_arena> arena;
};

ThreadLimit::ThreadLimit(int threads) : scope_(std::make_unique<Scope>(threads)) {}

ThreadLimit::~ThreadLimit() {
  context.max_threads = scope_->outer.max_threads;
  context.arena = scope_->outer.arena;
}

LoopCheck::LoopCheck(std::function<void()> check)
    : check_(std::move(check)), outer_(std::exchange(context.check, &check_)) {}

LoopCheck::~LoopCheck() { context.check = outer_; }

void check_loop() {
  if (context.check) (*context.check)();
}

int thread_count() {
  return context.max_threads > 0 ? context.max_threads
                                 : std::max(1, tbb::info::default_concurrency());
}

void parallel_chunks(std::size_t n, std::size_t grain,
                     const std::function<void(std::size_t, std::size_t)>& body) {
  grain = std::max<std::size_t>(1, grain);
  const std::size_t chunks = (n + grain - 1) / grain;
  const LoopContext of_loop = context;
  const auto run_chunk = [&](std::size_t c) {
    const ChunkContext of_chunk(of_loop);
    check_loop();
    body(c * grain, std::min(n, (c + 1) * grain));
  };
  if (chunks <= 1 || thread_count() == 1) {
    for (std::size_t c = 0; c < chunks; ++c) run_chunk(c);
    return;
  }
  const auto run_all = [&] {
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, chunks, 1),
        [&](const tbb::blocked_range<std::size_t>& r) {
          for (std::size_t c = r.begin(); c != r.end(); ++c) run_chunk(c);
        },
        tbb::simple_partitioner{});
  };
  if (of_loop.arena) {
    of_loop.arena->execute(run_all);
  } else {
    run_all();
  }
}

}  // namespace mdk
