// Assimp's meshes and bones as glTF meshes and skins.
#pragma once

#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "formats/assimp/scene_import.h"

namespace mdk {

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

}  // namespace mdk
