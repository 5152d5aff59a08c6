// RLIMIT_DATA counts private writable pages: heap, stacks, anonymous maps. What else is resident,
// code and libraries, is taken off first.
#include "preprocess/cli/memory_limit.h"

#include <unistd.h>

#include <algorithm>
#include <fstream>

#include "common/base/error.h"
#include "preprocess/cli/number_text.h"

namespace mdk {
namespace {

constexpr std::uint64_t kLeastRoom = std::uint64_t{16}
                                     << 20;  // to start threads and say a sentence

/// Resident pages that files stand behind.
std::uint64_t program_bytes() {
  std::ifstream statm("/proc/self/statm");
  std::uint64_t size = 0, resident = 0, shared = 0;
  if (!(statm >> size >> resident >> shared)) return 0;
  return shared * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

}  // namespace

MemoryLimit::MemoryLimit(const std::string& text) {
  if (text == "none") return;
  bytes_ = parse_size("--memory-limit", text);
  const std::uint64_t program = program_bytes();
  if (bytes_ < program + kLeastRoom)
    throw Error(ErrorCode::kOverLimit, "--memory-limit " + text + ": the program itself needs " +
                                           bytes_text(program + kLeastRoom) + "; allow more");
  getrlimit(RLIMIT_DATA, &before_);
  const rlimit limit{std::min<rlim_t>(bytes_ - program, before_.rlim_max), before_.rlim_max};
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
