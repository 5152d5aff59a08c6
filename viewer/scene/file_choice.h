// FileChoice: animations that can be opened, as a list shows them.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace mdk {

/// A .mdk file, or the source files of one animation.
struct FileChoice {
  std::string label;
  std::vector<std::string> paths;

  bool operator==(const FileChoice&) const = default;
};

/// A list that stands in the window until something is chosen.
struct FileMenu {
  std::string title;
  std::vector<FileChoice> choices;
  std::string typed;  ///< a path by hand
};

/// The latest files, newest first: puts `paths` in front, once, by their absolute names, and lets
/// the oldest go.
void remember_file(std::vector<FileChoice>& recent, const std::vector<std::string>& paths);

inline constexpr std::size_t kMostRecentFiles = 12;

}  // namespace mdk
