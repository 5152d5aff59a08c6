// MappedFile: a regular file's bytes as read-only memory, and what happens where the file gets
// lost.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace mdk {

class MappedFile {
 public:
  /// Throws Error (kIo): missing, not allowed, a folder or another thing that cannot be mapped.
  explicit MappedFile(const std::string& path);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  /// Starts on a page. A file that is truncated by others while it is mapped faults when
  /// read (name_lost_mappings).
  std::span<const std::byte> bytes() const { return bytes_; }

 private:
  std::span<const std::byte> bytes_;
};

/// XXH3, 64 bits, of a piece of memory.
std::uint64_t checksum_of(std::span<const std::byte> bytes);

/// From now on, touching a mapped part of a file that is no longer there, since another program cut
/// it short or its disk failed, ends the process with status 4 and one sentence on stderr that
/// names the program and the file; the system's own end is a bus error without a word. For main of
/// a program only: it counts for the whole process. Other bus errors end it as before.
void name_lost_mappings();

}  // namespace mdk
