// Reads what Assimp reads: FBX, Collada, MD5 and more, through the program mdk-assimp.
#pragma once

#include <string>

#include "common/base/parallel.h"
#include "formats/reading.h"

namespace mdk {

/// The file as read_gltf would read it as glTF: what Assimp makes of it comes as one from a process
/// of its own, and is checked like any other. `read_through` and a note say so. Names of images and
/// of files beside it lead no farther than its folder. Throws Error: what read_gltf throws;
/// kBadInput, too, where Assimp refuses the file or crashes on it, kOverLimit where it takes over
/// ten minutes or 8 GiB (or the memory this process may have).
ReadResult read_with_assimp(const std::string& path, const ReadOptions& options,
                            ProgressSink& progress);

}  // namespace mdk
