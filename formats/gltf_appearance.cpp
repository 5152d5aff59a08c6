#include "formats/gltf_appearance.h"

#include <algorithm>
#include <string>
#include <utility>

#include "common/base/error.h"
#include "formats/gltf_image.h"

namespace mdk::gltf {
namespace {

constexpr std::uint32_t kWhite = 0xffffffffu;

}  // namespace

void AppearanceBuilder::add(const PrimitiveGeometry& geometry,
                            std::span<const Triangle> triangles) {
  const std::size_t corners_before = 3 * appearance_.triangle_materials.size();
  const std::size_t corners_after = corners_before + 3 * triangles.size();
  appearance_.triangle_materials.resize(corners_after / 3, material_for(geometry));
  // The first primitive with such data starts the list; corners before and after it get a default.
  if (!geometry.texcoords.empty() || !appearance_.corner_texcoords.empty())
    appearance_.corner_texcoords.resize(corners_after);
  if (!geometry.colors.empty() || !appearance_.corner_colors.empty())
    appearance_.corner_colors.resize(corners_after, kWhite);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t corner = corners_before + 3 * t + c;
      const std::uint32_t v = triangles[t].v[c];
      if (!geometry.texcoords.empty()) appearance_.corner_texcoords[corner] = geometry.texcoords[v];
      if (!geometry.colors.empty()) appearance_.corner_colors[corner] = geometry.colors[v];
    }
  }
}

Appearance AppearanceBuilder::take() {
  if (appearance_.materials.empty()) appearance_.materials.push_back({});
  return std::exchange(appearance_, {});
}

std::uint32_t AppearanceBuilder::material_for(const PrimitiveGeometry& geometry) {
  const auto key = std::tuple(geometry.material, geometry.has_normals, !geometry.texcoords.empty());
  const auto known = materials_.find(key);
  if (known != materials_.end()) return known->second;

  Material material;
  std::ranges::fill(material.base_color, 1.0f);  // glTF's default, where no material is named
  if (geometry.material != kNone) {
    const MaterialSource& source = document_.materials[static_cast<std::size_t>(geometry.material)];
    material = source.material;
    if (!geometry.texcoords.empty()) material.texture = texture_for(source.image);
  }
  if (!geometry.has_normals) material.flags |= kMaterialFlatShaded;
  const auto number = static_cast<std::uint32_t>(appearance_.materials.size());
  appearance_.materials.push_back(material);
  return materials_[key] = number;
}

std::uint32_t AppearanceBuilder::texture_for(int image) {
  const auto known = textures_.find(image);
  if (known != textures_.end()) return known->second;
  return textures_[image] = load_texture(image);
}

std::uint32_t AppearanceBuilder::load_texture(int image) {
  const ImageSource& source = document_.images[static_cast<std::size_t>(image)];
  const auto leave_out = [&](const std::string& why) {
    notes_.add("image " + std::to_string(image) + " " + why + "; the plain base colour is shown");
    return kNoTexture;
  };
  Bytes file;
  std::span<const unsigned char> bytes = source.bytes;
  if (bytes.empty()) {
    std::string path;
    try {
      path = resolve_uri(document_.path, source.uri);
      file = read_whole_file(path);
    } catch (const Error&) {
      if (!path.empty()) document_.unread.push_back(path);
      return leave_out("(\"" + source.uri.substr(0, 200) + "\") cannot be read");
    }
    document_.dependencies.push_back(path);
    bytes = file;
  }
  std::string problem;
  const std::uint32_t number = add_texture(bytes, appearance_, problem);
  if (number == kNoTexture) return leave_out(problem);
  return number;
}

}  // namespace mdk::gltf
