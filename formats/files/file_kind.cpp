#include "formats/files/file_kind.h"

#include <algorithm>
#include <array>
#include <filesystem>

namespace mdk {
namespace {

constexpr std::array<std::string_view, 1> kBaked = {".mdk"};
constexpr std::array<std::string_view, 2> kGltf = {".gltf", ".glb"};
constexpr std::array<std::string_view, 11> kForAssimp = {
    ".3ds", ".ase", ".b3d", ".bvh", ".dae", ".fbx", ".lws", ".md5mesh", ".ms3d", ".smd", ".x"};
constexpr std::array<std::string_view, 2> kMesh = {".obj", ".ply"};
constexpr std::array<std::string_view, 2> kPointCache = {".pc2", ".mdd"};

constexpr std::array kKinds = {FileKind::kBaked, FileKind::kGltf, FileKind::kForAssimp,
                               FileKind::kMesh, FileKind::kPointCache};

}  // namespace

std::span<const std::string_view> extensions_of(FileKind kind) {
  switch (kind) {
    case FileKind::kOther:
      break;
    case FileKind::kBaked:
      return kBaked;
    case FileKind::kGltf:
      return kGltf;
    case FileKind::kForAssimp:
      return kForAssimp;
    case FileKind::kMesh:
      return kMesh;
    case FileKind::kPointCache:
      return kPointCache;
  }
  return {};
}

std::string lower_extension(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::ranges::transform(extension, extension.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  return extension;
}

FileKind file_kind(const std::string& path) {
  const std::string extension = lower_extension(path);
  for (const FileKind kind : kKinds) {
    const auto extensions = extensions_of(kind);
    if (std::ranges::find(extensions, extension) != extensions.end()) return kind;
  }
  return FileKind::kOther;
}

#ifdef MDK_HAVE_ASSIMP
bool has_assimp() { return true; }
#else
bool has_assimp() { return false; }
#endif

}  // namespace mdk
