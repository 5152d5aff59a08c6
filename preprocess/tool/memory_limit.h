// MemoryLimit: holds the process to an amount of memory, so that a job that needs more says so
// instead of pushing its neighbours out.
#pragma once

#include <sys/resource.h>

#include <cstdint>

namespace mdk {

/// While it lives, an allocation past the limit throws std::bad_alloc. Counted are the program
/// itself and what it allocates; files that are mapped, which the system may drop, are not.
class MemoryLimit {
 public:
  /// 0: no limit. Throws Error (kOverLimit) where the program itself does not fit.
  explicit MemoryLimit(std::uint64_t bytes);
  ~MemoryLimit();
  MemoryLimit(const MemoryLimit&) = delete;
  MemoryLimit& operator=(const MemoryLimit&) = delete;

  /// 0: no limit.
  std::uint64_t bytes() const { return bytes_; }

  /// What counts for it now.
  std::uint64_t counted_bytes() const;

 private:
  std::uint64_t bytes_ = 0, program_bytes_ = 0, stack_bytes_ = 0;
  rlimit before_ = {};
};

/// The largest amount of memory that this process had resident.
std::uint64_t peak_memory_bytes();

}  // namespace mdk
