// FileState: what a file held, in a few bytes, so that a later run can tell whether it still does.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace mdk {

struct FileState {
  std::string path;
  std::uint64_t bytes = 0;
  std::uint64_t hash = 0;  ///< XXH3 of the content

  bool operator==(const FileState&) const = default;
};

/// Reads the whole file. Throws Error (kIo).
FileState state_of_file(const std::string& path);

std::vector<FileState> states_of_files(const std::vector<std::string>& paths);

/// Whether every file is there and holds what it held.
bool are_unchanged(const std::vector<FileState>& states);

/// Whether it is a file and opens.
bool is_readable(const std::string& path);

}  // namespace mdk
