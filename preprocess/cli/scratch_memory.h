// ScratchMemory: large lists stand in a file on disk, so that a long sequence needs no memory of
// its own size: the system writes out what is not in use.
#pragma once

#include <cstdint>
#include <string>

namespace mdk {

/// While it lives, operator new gives blocks of at least `smallest_block` bytes, the poses of a
/// long sequence above all, as shared mappings of files that have no name: nothing can be left
/// behind, however the process ends. They do not count for --memory-limit. Where the folder has no
/// room, or its file system no such files, a block comes from memory as ever. Only one lives at a
/// time; blocks may outlive it.
class ScratchMemory {
 public:
  /// 0 bytes: no block is large.
  ScratchMemory(const std::string& folder, std::uint64_t smallest_block);
  ~ScratchMemory();
  ScratchMemory(const ScratchMemory&) = delete;
  ScratchMemory& operator=(const ScratchMemory&) = delete;

  /// The most that ever stood in files at once, in this process.
  static std::uint64_t peak_bytes();
};

}  // namespace mdk
