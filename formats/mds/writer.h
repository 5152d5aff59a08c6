// Writes a scene as one .mds image (docs/scene-file.md).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

#include "common/scene/scene.h"
#include "formats/files/atomic_file.h"
#include "formats/mds/mds_file.h"

namespace mdk {

struct MdsWriteOptions {
  std::array<std::uint16_t, 3> version = {};  ///< of the program: major, minor, patch
  std::uint64_t options_hash = 0;
  Overwrite overwrite = Overwrite::kAlways;
};

/// Writes the whole file or nothing: a temporary name in the same folder, fsync, rename. The bytes
/// depend on the arguments but for the path. Returns the file's size in bytes. Throws Error (kIo)
/// naming `path`, kInternal for a scene that could not be opened again.
std::uint64_t write_mds(const SceneView& scene, std::span<const SceneModelFile> models,
                        const std::string& path, const MdsWriteOptions& options = {});

}  // namespace mdk
