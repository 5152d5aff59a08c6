#include "viewer/source_file.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <string_view>

#include "common/base/error.h"

namespace mdk {

void refuse_source_file(const std::string& path) {
  constexpr std::array<std::string_view, 2> kSources = {".gltf", ".glb"};
  const std::filesystem::path file(path);
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (std::find(kSources.begin(), kSources.end(), extension) == kSources.end()) return;
  const std::string name = file.filename().string(), baked = file.stem().string() + ".mdk";
  throw bad_input(name, "bake it first: mdprep bake " + path + " -o " + baked);
}

}  // namespace mdk
