#include "common/base/parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>

namespace mdk {
namespace {

// Process-wide, as oneTBB's own limit of threads is: loops lie too deep to hand it down to each.
std::atomic<void (*)()> loop_check = nullptr;

}  // namespace

ThreadLimit::ThreadLimit(int threads) {
  const std::size_t n =
      static_cast<std::size_t>(threads > 0 ? threads : tbb::info::default_concurrency());
  control_ = new tbb::global_control(tbb::global_control::max_allowed_parallelism, n);
}

ThreadLimit::~ThreadLimit() { delete static_cast<tbb::global_control*>(control_); }

LoopCheck::LoopCheck(void (*check)()) { loop_check = check; }

LoopCheck::~LoopCheck() { loop_check = nullptr; }

void check_loop() {
  if (void (*const check)() = loop_check) check();
}

int thread_count() {
  const auto limit =
      tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  return static_cast<int>(std::max<std::size_t>(1, limit));
}

void parallel_chunks(std::size_t n, std::size_t grain,
                     const std::function<void(std::size_t, std::size_t)>& body) {
  grain = std::max<std::size_t>(1, grain);
  const std::size_t chunks = (n + grain - 1) / grain;
  const auto run_chunk = [&](std::size_t c) {
    check_loop();
    body(c * grain, std::min(n, (c + 1) * grain));
  };
  if (chunks <= 1 || thread_count() == 1) {
    for (std::size_t c = 0; c < chunks; ++c) run_chunk(c);
    return;
  }
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, chunks, 1),
      [&](const tbb::blocked_range<std::size_t>& r) {
        for (std::size_t c = r.begin(); c != r.end(); ++c) run_chunk(c);
      },
      tbb::simple_partitioner{});
}

}  // namespace mdk
