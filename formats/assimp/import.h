// From a scene as Assimp has read it to the glTF that this project's own reader takes: a step a
// file (scene, geometry, materials, motion), and what they share.
#pragma once

#include <assimp/scene.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "common/base/error.h"
#include "formats/files/notes.h"

namespace mdk {

using Json = nlohmann::ordered_json;

/// A binary glTF in the making: objects of its JSON, and numbers that accessors find.
class GlbBuilder {
 public:
  /// `path`: of the input, for messages.
  explicit GlbBuilder(const std::string& path);

  /// Appends to the list `kind` ("meshes") and returns its number.
  std::size_t add(const char* kind, Json object);
  Json& at(const char* kind, std::size_t number) { return root_[kind][number]; }

  /// A new buffer view. Throws Error (kOverLimit) past 4 GiB in all.
  std::size_t add_bytes(std::span<const unsigned char> bytes);
  /// New accessors; `type` as in glTF ("VEC3"), at least one element.
  std::size_t add_floats(const char* type, std::span<const float> numbers);
  std::size_t add_indices(std::span<const std::uint32_t> numbers);
  std::size_t add_joints(std::span<const std::uint16_t> numbers);

  /// The file. The builder is empty afterwards.
  std::vector<unsigned char> finish();

 private:
  std::size_t add_accessor(const char* type, int component_type,
                           std::span<const unsigned char> bytes, std::size_t count);

  const std::string& path_;
  Json root_;
  std::vector<unsigned char> binary_;
};

struct SceneImport {
  SceneImport(const aiScene& from, const std::string& input)
      : scene(from), path(input), glb(input) {}

  const aiScene& scene;
  const std::string& path;  ///< of the input
  GlbBuilder glb;
  std::vector<std::string> notes;  ///< each once

  std::vector<const aiNode*> nodes;  ///< parents first; their numbers are glTF's
  std::unordered_map<std::string, std::size_t> node_numbers;  ///< by name: the first of it

  void note(const std::string& sentence) { add_note(notes, sentence); }
  [[noreturn]] void fail(const std::string& sentence) const { throw bad_input(path, sentence); }
};

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

/// What a node shows.
struct ShownMesh {
  std::optional<std::size_t> mesh;  ///< none where nothing of it has triangles
  std::optional<std::size_t> skin;
};

/// Makes one glTF mesh, of a primitive for each aiMesh, and one skin, of all their bones, for each
/// set of meshes that nodes show together.
class GeometryImport {
 public:
  explicit GeometryImport(SceneImport& import) : import_(import) {}

  /// Throws Error (kBadInput) naming the mesh for numbers that are not finite, vertices or bones
  /// that are not there; kOverLimit.
  ShownMesh add(const aiNode& node);

  /// Morph targets of what a node shows: the most of any of its meshes.
  std::size_t target_count(const aiNode& node) const;

 private:
  struct Skin;
  /// The meshes of a node that have triangles.
  std::vector<unsigned> shown_meshes(const aiNode& node);
  Json primitive(const aiMesh& mesh, std::size_t targets, Skin& skin);
  Json target(const aiMesh& mesh, std::size_t number);
  void add_bones(const aiMesh& mesh, Skin& skin, Json& attributes);

  SceneImport& import_;
  std::map<std::vector<unsigned>, ShownMesh> shown_;
};

/// One glTF material for each of the scene's. Colours of formats that do not say otherwise are
/// taken as sRGB. An image has to be in the input or, by its name at least, in its folder;
/// otherwise a note says so.
void add_materials(SceneImport& import);

/// One glTF animation for each of the scene's that moves something. `target_counts`: per node, the
/// morph targets of what it shows. Times in ticks become seconds. Throws Error (kBadInput) for
/// numbers that are not finite.
void add_animations(SceneImport& import, std::span<const std::size_t> target_counts);

/// Per node, whether an animation moves it.
std::vector<char> moved_nodes(const SceneImport& import);

struct SceneGlb {
  std::vector<unsigned char> bytes;
  std::vector<std::string> notes;  ///< one sentence per thing left out
};

/// Nodes, meshes, skins, morph targets, animations, base colours and images. +y up as Assimp turns
/// it, in metres where the file says its unit (FBX). Throws Error: kBadInput for what does not fit
/// together, kOverLimit.
SceneGlb encode_scene(const aiScene& scene, const std::string& path);

}  // namespace mdk
