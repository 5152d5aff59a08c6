// RLIMIT_DATA counts private writable pages: heap, stacks, anonymous maps. What else is resident,
// code and libraries, is taken off first.
#include "preprocess/cli/memory_limit.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <fstream>
#include <thread>

#include "common/base/error.h"
#include "common/base/parallel.h"
#include "preprocess/cli/number_text.h"

namespace mdk {
namespace {

/// What oneTBB reserves for the stack of a thread; next to nothing of it is ever touched.
constexpr std::uint64_t kStackBytes = std::uint64_t{4} << 20;
constexpr std::uint64_t kLeastRoom = std::uint64_t{16}
                                     << 20;  // to start threads and say a sentence

/// Resident pages that files stand behind.
std::uint64_t program_bytes() {
  std::ifstream statm("/proc/self/statm");
  std::uint64_t size = 0, resident = 0, shared = 0;
  if (!(statm >> size >> resident >> shared)) return 0;
  return shared * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

/// Starts the threads of parallel loops: oneTBB brings the program down where it cannot do so
/// later.
void start_threads() {
  const auto threads = static_cast<std::size_t>(thread_count());
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::milliseconds(200);
  std::atomic<std::size_t> running = 0;
  parallel_chunks(threads, 1, [&](std::size_t, std::size_t) {
    ++running;
    while (running < threads && std::chrono::steady_clock::now() < deadline)
      std::this_thread::yield();
  });
}

}  // namespace

MemoryLimit::MemoryLimit(const std::string& text) {
  if (text == "none") return;
  bytes_ = parse_size("--memory-limit", text);
  const std::uint64_t program = program_bytes();
  if (bytes_ < program + kLeastRoom)
    throw Error(ErrorCode::kOverLimit, "--memory-limit " + text + ": the program itself needs " +
                                           bytes_text(program + kLeastRoom) + "; allow more");
  start_threads();
  const std::uint64_t stacks = static_cast<std::uint64_t>(thread_count() - 1) * kStackBytes;
  getrlimit(RLIMIT_DATA, &before_);
  const rlimit limit{std::min<rlim_t>(bytes_ - program + stacks, before_.rlim_max),
                     before_.rlim_max};
  setrlimit(RLIMIT_DATA, &limit);
}

MemoryLimit::~MemoryLimit() {
  if (bytes_ > 0) setrlimit(RLIMIT_DATA, &before_);
}

std::uint64_t peak_memory_bytes() {
  rusage usage = {};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;  // Linux counts in KiB
}

}  // namespace mdk
