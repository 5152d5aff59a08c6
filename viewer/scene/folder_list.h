// FolderList: the animations in a folder that was dropped on the window.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "viewer/scene/file_choice.h"

namespace mdk {

inline constexpr std::size_t kMostListedFiles = 10000;

/// Baked files first, then glTF, then what is read through Assimp (in a build that has it), then
/// meshes with the point caches that move them (of the same name), then the folder itself where it
/// holds a sequence of meshes; by name. Looks at no more
/// than kMostListedFiles files and into no other folder. Empty where there is nothing to open.
/// Throws Error (kIo) where the folder cannot be read.
std::vector<FileChoice> animations_in(const std::string& folder);

/// ".mdk, .gltf, ...": of the files that hold an animation each, as this build opens them.
std::string openable_extensions();

}  // namespace mdk
