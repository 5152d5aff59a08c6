// What the steps from Assimp's scene to a glTF share.
#pragma once

#include <assimp/scene.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "common/base/error.h"
#include "formats/assimp/glb_builder.h"

namespace mdk {

struct SceneImport {
  SceneImport(const aiScene& from, const std::string& input)
      : scene(from), path(input), glb(input) {}

  const aiScene& scene;
  const std::string& path;  ///< of the input
  GlbBuilder glb;
  std::vector<std::string> notes;  ///< each once

  std::vector<const aiNode*> nodes;  ///< parents first; their numbers are glTF's
  std::unordered_map<std::string, std::size_t> node_numbers;  ///< by name: the first of it

  void note(const std::string& sentence) {
    if (std::ranges::find(notes, sentence) == notes.end()) notes.push_back(sentence);
  }
  [[noreturn]] void fail(const std::string& sentence) const { throw bad_input(path, sentence); }
};

/// Whether the name ends in `extension` (lower case, with its dot), in letters of any case.
inline bool has_extension(const std::string& path, std::string_view extension) {
  const std::string end = std::filesystem::path(path).extension().string();
  return std::ranges::equal(end, extension, [](char a, char b) {
    return (a >= 'A' && a <= 'Z' ? a - 'A' + 'a' : a) == b;
  });
}

/// As glTF writes matrices.
inline std::array<float, 16> columns_of(const aiMatrix4x4& m) {
  return {m.a1, m.b1, m.c1, m.d1, m.a2, m.b2, m.c2, m.d2,
          m.a3, m.b3, m.c3, m.d3, m.a4, m.b4, m.c4, m.d4};
}

/// Not more of a name than a message can hold.
inline std::string quoted_name(const aiString& name) {
  std::string text(1, '"');
  text.append(std::string(name.C_Str()).substr(0, 60));
  return text.append(1, '"');
}

}  // namespace mdk
