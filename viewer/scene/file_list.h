// FileList: animations that can be opened: those in a folder, and those opened last.
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

inline constexpr std::size_t kMaxRecentFiles = 12, kMaxListedFiles = 10000;

/// The latest files, newest first: puts `paths` in front, once, by their absolute names, and drops
/// the oldest.
void remember_file(std::vector<FileChoice>& recent, const std::vector<std::string>& paths);

/// Baked files first, then glTF, then what is read through Assimp (in a build that has it), then
/// meshes with the point caches that move them (of the same name), then the folder itself where it
/// holds a sequence of meshes; by name. Looks at no more than kMaxListedFiles files and into no
/// other folder. Empty where there is nothing to open. Throws Error (kIo) where the folder cannot
/// be read.
std::vector<FileChoice> animations_in(const std::string& folder);

/// ".mdk, .gltf, ...": of the files that hold an animation each, as this build opens them.
std::string openable_extensions();

}  // namespace mdk
