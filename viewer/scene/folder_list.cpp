#include "viewer/scene/folder_list.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>

#include "common/base/error.h"

namespace mdk {
namespace {

namespace fs = std::filesystem;

std::string lower_extension(const fs::path& path) {
  std::string extension = path.extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

std::vector<fs::path> files_in(const std::string& folder) {
  std::error_code failure;
  std::vector<fs::path> files;
  fs::directory_iterator at(folder, failure);
  for (; !failure && at != fs::directory_iterator() && files.size() < kMostListedFiles;
       at.increment(failure)) {
    std::error_code gone;
    if (at->is_regular_file(gone)) files.push_back(at->path());
  }
  if (failure) throw Error(ErrorCode::kIo, folder + ": cannot be read: " + failure.message());
  std::ranges::sort(files);
  return files;
}

bool ends_in_digit(const fs::path& path) {
  const std::string stem = path.stem().string();
  return !stem.empty() && std::isdigit(static_cast<unsigned char>(stem.back())) != 0;
}

}  // namespace

std::vector<FileChoice> animations_in(const std::string& folder) {
  std::vector<FileChoice> baked, gltf, meshes;
  std::size_t poses = 0;
  const std::vector<fs::path> files = files_in(folder);
  for (const fs::path& file : files) {
    const std::string extension = lower_extension(file), name = file.filename().string();
    if (extension == ".mdk") baked.push_back({name, {file.string()}});
    if (extension == ".glb" || extension == ".gltf") gltf.push_back({name, {file.string()}});
    if (extension != ".obj" && extension != ".ply") continue;
    bool has_cache = false;
    for (const char* cache : {".pc2", ".mdd"}) {
      const fs::path beside = fs::path(file).replace_extension(cache);
      if (!std::ranges::binary_search(files, beside)) continue;
      meshes.push_back(
          {name + " + " + beside.filename().string(), {file.string(), beside.string()}});
      has_cache = true;
    }
    if (!has_cache && ends_in_digit(file)) ++poses;
  }
  std::vector<FileChoice> all = std::move(baked);
  all.insert(all.end(), gltf.begin(), gltf.end());
  all.insert(all.end(), meshes.begin(), meshes.end());
  if (poses > 1) all.push_back({std::to_string(poses) + " poses, one animation", {folder}});
  return all;
}

}  // namespace mdk
