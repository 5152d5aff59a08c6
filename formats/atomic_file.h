// AtomicFile: a file that appears under its name whole or not at all.
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace mdk {

/// Writes to a new file next to `path` and renames it over `path` at the end. Whoever has the old
/// file open or mapped keeps it as it was. A symbolic link at `path` is replaced, not followed.
class AtomicFile {
 public:
  /// Creates the temporary file. Throws Error (kIo): no such folder, not allowed, or something
  /// other than a regular file stands at `path` (a folder, a device).
  explicit AtomicFile(const std::string& path);
  /// Removes the temporary file unless committed.
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// Appends. Throws Error (kIo), e.g. where the disk is full.
  void write(std::span<const std::byte> bytes);

  /// Brings everything to the disk (fsync) and renames. Throws Error (kIo). Call once, last.
  void commit();

  const std::string& temporary_path() const { return temporary_path_; }

 private:
  std::string path_;
  std::string folder_;
  std::string temporary_path_;  ///< empty once renamed
  int descriptor_ = -1;
};

}  // namespace mdk
