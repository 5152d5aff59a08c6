// Names of files: what a file is taken for by its extension, one list for all who open or offer
// files, and where the names lead that stand in a file.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
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

inline constexpr std::size_t kMaxNameBytes = 1000;

/// Where `name` leads from the folder of `file`. Nothing where it is empty, absolute, longer than
/// any name, or leaves the folder. Names are judged, not links: a link inside the folder is the
/// decision of whoever made the folder.
inline std::optional<std::string> neighbor_path(const std::string& file, const std::string& name) {
  if (name.size() > kMaxNameBytes || name.find('\0') != std::string::npos) return std::nullopt;
  const std::filesystem::path relative = std::filesystem::path(name).lexically_normal();
  if (relative.is_absolute() || relative.empty() || *relative.begin() == ".." ||
      *relative.begin() == ".")
    return std::nullopt;
  return (std::filesystem::path(file).parent_path() / relative).string();
}

}  // namespace mdk
