// AtomicFile: a file that appears under its name whole or not at all.
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace mdk {

/// What to do with an old file that has the new one's content already.
enum class Overwrite {
  kAlways,
  kIfChanged,  ///< leave it alone, its time stamp too: what was made from it need not be made again
};

/// Writes to a new file next to `path` and renames it over `path` at the end. Whoever has the old
/// file open or mapped keeps it as it was. A symbolic link at `path` is replaced, not followed.
class AtomicFile {
 public:
  /// Creates the temporary file and locks it while this lives (flock). Throws Error (kIo): no such
  /// folder, not allowed, or something other than a regular file stands at `path` (a folder, a
  /// device).
  explicit AtomicFile(const std::string& path, Overwrite overwrite = Overwrite::kAlways);
  /// Removes the temporary file unless committed.
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// Appends. Throws Error (kIo), e.g. where the disk is full.
  void write(std::span<const std::byte> bytes);

  /// Brings everything to the disk (fsync) and renames, or leaves the old file where Overwrite says
  /// so. Throws Error (kIo). Call once, last.
  void commit();

  const std::string& temporary_path() const { return temporary_path_; }

 private:
  bool create(const std::string& candidate);
  bool old_file_is_equal() const;

  std::string path_;
  Overwrite overwrite_;
  std::string folder_;
  std::string temporary_path_;  ///< empty once renamed
  int descriptor_ = -1;
};

/// Removes the temporary files in a folder whose writers are gone without a word (SIGKILL, a node
/// that fell over): nobody holds their lock. Those of living writers stay, on other machines, too,
/// where the file system passes locks on. Returns how many. Does nothing where it may not.
std::size_t remove_abandoned_temporaries(const std::string& folder);

}  // namespace mdk
