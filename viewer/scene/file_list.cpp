#include "viewer/scene/file_list.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <iterator>

#include "common/base/error.h"
#include "formats/files/file_kind.h"

namespace mdk {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> files_in(const std::string& folder) {
  std::error_code failure;
  std::vector<fs::path> files;
  fs::directory_iterator at(folder, failure);
  for (; !failure && at != fs::directory_iterator() && files.size() < kMaxListedFiles;
       at.increment(failure)) {
    std::error_code gone;
    if (at->is_regular_file(gone)) files.push_back(at->path());
  }
  if (failure) throw Error(ErrorCode::kIo, folder + ": cannot be read: " + failure.message());
  std::ranges::sort(files);
  return files;
}

/// The mesh with each point cache of its name; `files` is sorted.
std::vector<FileChoice> with_caches(const fs::path& mesh, const std::vector<fs::path>& files) {
  std::vector<FileChoice> choices;
  for (const std::string_view extension : extensions_of(FileKind::kPointCache)) {
    const fs::path cache = fs::path(mesh).replace_extension(extension);
    if (std::ranges::binary_search(files, cache))
      choices.push_back({mesh.filename().string() + " + " + cache.filename().string(),
                         {mesh.string(), cache.string()}});
  }
  return choices;
}

bool ends_in_digit(const fs::path& path) {
  const std::string stem = path.stem().string();
  return !stem.empty() && std::isdigit(static_cast<unsigned char>(stem.back())) != 0;
}

}  // namespace

void remember_file(std::vector<FileChoice>& recent, const std::vector<std::string>& paths) {
  if (paths.empty()) return;
  FileChoice choice;
  std::error_code failure;
  for (const std::string& path : paths) {
    const auto whole = fs::absolute(path, failure).lexically_normal();
    choice.paths.push_back(failure ? path : whole.string());
  }
  const fs::path first(choice.paths.front());
  choice.label = first.has_filename() ? first.filename().string()
                                      : first.parent_path().filename().string() + "/";
  std::erase_if(recent, [&](const FileChoice& old) { return old.paths == choice.paths; });
  recent.insert(recent.begin(), std::move(choice));
  if (recent.size() > kMaxRecentFiles) recent.resize(kMaxRecentFiles);
}

std::vector<FileChoice> animations_in(const std::string& folder) {
  std::vector<FileChoice> baked, gltf, for_assimp, meshes;
  std::size_t poses = 0;
  const std::vector<fs::path> files = files_in(folder);
  for (const fs::path& file : files) {
    const FileChoice alone{file.filename().string(), {file.string()}};
    switch (file_kind(file.string())) {
      case FileKind::kBaked:
        baked.push_back(alone);
        break;
      case FileKind::kGltf:
        gltf.push_back(alone);
        break;
      case FileKind::kForAssimp:
        if (has_assimp()) for_assimp.push_back(alone);
        break;
      case FileKind::kMesh: {
        std::vector<FileChoice> moved = with_caches(file, files);
        if (moved.empty() && ends_in_digit(file)) ++poses;
        std::ranges::move(moved, std::back_inserter(meshes));
        break;
      }
      case FileKind::kPointCache:
      case FileKind::kOther:
        break;
    }
  }
  std::vector<FileChoice> all = std::move(baked);
  for (std::vector<FileChoice>* kind : {&gltf, &for_assimp, &meshes})
    std::ranges::move(*kind, std::back_inserter(all));
  if (poses > 1) all.push_back({std::to_string(poses) + " poses, one animation", {folder}});
  return all;
}

std::string openable_extensions() {
  std::string text;
  const auto add = [&](FileKind kind) {
    for (const std::string_view extension : extensions_of(kind))
      text.append(text.empty() ? "" : ", ").append(extension);
  };
  add(FileKind::kBaked);
  add(FileKind::kGltf);
  if (has_assimp()) add(FileKind::kForAssimp);
  return text;
}

}  // namespace mdk
