// Materials, textures and corner attributes of the primitives that are shown.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <tuple>

#include "common/motion/pose_sequence.h"
#include "formats/gltf_document.h"
#include "formats/gltf_geometry.h"

namespace mdk::gltf {

/// Gathers an appearance, primitive by primitive, in triangle order.
class AppearanceBuilder {
 public:
  /// Keeps references to both; image files that are read are added to `document.dependencies`.
  AppearanceBuilder(Document& document, Notes& notes) : document_(document), notes_(notes) {}

  /// Adds `triangles` of `geometry` (its own vertex numbers, as wound in the result). An image that
  /// is missing or broken becomes a note and the plain base colour.
  void add(const PrimitiveGeometry& geometry, std::span<const Triangle> triangles);

  /// What was gathered; the builder is empty afterwards.
  Appearance take();

 private:
  std::uint32_t material_for(const PrimitiveGeometry& geometry);
  std::uint32_t texture_for(int image);
  std::uint32_t load_texture(int image);

  Document& document_;
  Notes& notes_;
  Appearance appearance_;
  std::map<std::tuple<int, bool, bool>, std::uint32_t> materials_;  ///< source, normals, texcoords
  std::map<int, std::uint32_t> textures_;                           ///< by image
};

}  // namespace mdk::gltf
