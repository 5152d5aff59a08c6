// What a file is taken for, by the extension of its name: one list for all who open or offer files.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace mdk {

enum class FileKind {
  kOther,
  kBaked,       ///< .mdk
  kGltf,        ///< .gltf, .glb
  kForAssimp,   ///< formats with moving meshes that are read through Assimp; see has_assimp()
  kMesh,        ///< .obj, .ply: one pose, or moved by a point cache
  kPointCache,  ///< .pc2, .mdd
};

/// Upper and lower case do not matter. Opens no file.
FileKind file_kind(const std::string& path);

/// Lower case, with their dots.
std::span<const std::string_view> extensions_of(FileKind kind);

/// Of a name, lower case, with its dot; empty where there is none.
std::string lower_extension(const std::string& path);

/// Whether this build reads files for Assimp: it has mdk-assimp.
bool has_assimp();

}  // namespace mdk
