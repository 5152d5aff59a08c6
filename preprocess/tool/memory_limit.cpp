// RLIMIT_DATA counts private writable pages: heap, stacks, anonymous maps. What else is resident,
// code and libraries, is taken off first.
#include "preprocess/tool/memory_limit.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <fstream>
#include <thread>

#include "common/base/error.h"
#include "common/base/parallel.h"
#include "preprocess/tool/text.h"

namespace mdk {
namespace {

constexpr std::uint64_t kMinRoom = std::uint64_t{16} << 20;   // to start threads and say a sentence
constexpr std::uint64_t kLaterCode = std::uint64_t{4} << 20;  // of the program, not yet resident

struct ProcessMemory {
  std::uint64_t program = 0;  ///< bytes: resident pages that files stand behind
  std::uint64_t data = 0;     ///< bytes that RLIMIT_DATA counts, touched or not
};

ProcessMemory process_memory() {
  std::ifstream statm("/proc/self/statm");
  std::uint64_t size = 0, resident = 0, shared = 0, text = 0, library = 0, data = 0;
  if (!(statm >> size >> resident >> shared >> text >> library >> data)) return {};
  const auto page = static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
  return {shared * page, data * page};
}

/// Starts the threads of parallel loops: where oneTBB cannot do so later, the program goes down.
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

MemoryLimit::MemoryLimit(std::uint64_t bytes) : bytes_(bytes) {
  if (bytes == 0) return;
  const auto [resident, data] = process_memory();
  const std::uint64_t program = resident + kLaterCode;
  if (bytes_ < program + kMinRoom)
    throw Error(ErrorCode::kOverLimit, "--memory-limit " + size_text(bytes) +
                                           ": the program itself needs " +
                                           bytes_text(program + kMinRoom) + "; allow more");
  start_threads();
  const std::uint64_t started = std::max(data, process_memory().data);
  const std::uint64_t stacks = started - data;  // hardly any of which is touched
  getrlimit(RLIMIT_DATA, &before_);
  const rlimit limit{std::min<rlim_t>(bytes_ - program + stacks, before_.rlim_max),
                     before_.rlim_max};
  setrlimit(RLIMIT_DATA, &limit);
  program_bytes_ = program;
  stack_bytes_ = stacks;
}

MemoryLimit::~MemoryLimit() {
  if (bytes_ > 0) setrlimit(RLIMIT_DATA, &before_);
}

std::uint64_t MemoryLimit::counted_bytes() const {
  return program_bytes_ + process_memory().data - stack_bytes_;
}

std::uint64_t peak_memory_bytes() {
  rusage usage = {};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;  // Linux counts in KiB
}

}  // namespace mdk
