// MappedFile: a regular file's bytes as read-only memory.
#pragma once

#include <cstddef>
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
  /// read (formats/lost_mappings.h).
  std::span<const std::byte> bytes() const { return bytes_; }

 private:
  std::span<const std::byte> bytes_;
};

}  // namespace mdk
