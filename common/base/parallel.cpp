#include "common/base/parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <utility>

namespace mdk {
namespace {

// Of the thread, since loops lie too deep to hand it down to each.
thread_local const std::function<void()>* loop_check = nullptr;

// Threads that help with a loop check what its own thread checks, while they do.
class InheritedCheck {
 public:
  explicit InheritedCheck(const std::function<void()>* check)
      : own_(std::exchange(loop_check, check)) {}
  ~InheritedCheck() { loop_check = own_; }
  InheritedCheck(const InheritedCheck&) = delete;
  InheritedCheck& operator=(const InheritedCheck&) = delete;

 private:
  const std::function<void()>* own_;
};

}  // namespace

ThreadLimit::ThreadLimit(int threads) {
  const std::size_t n =
      static_cast<std::size_t>(threads > 0 ? threads : tbb::info::default_concurrency());
  control_ = new tbb::global_control(tbb::global_control::max_allowed_parallelism, n);
}

ThreadLimit::~ThreadLimit() { delete static_cast<tbb::global_control*>(control_); }

LoopCheck::LoopCheck(std::function<void()> check)
    : check_(std::move(check)), outer_(std::exchange(loop_check, &check_)) {}

LoopCheck::~LoopCheck() { loop_check = outer_; }

void check_loop() {
  if (loop_check) (*loop_check)();
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
  const auto* const check = loop_check;
  const auto run_chunk = [&](std::size_t c) {
    const InheritedCheck inherited(check);
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
