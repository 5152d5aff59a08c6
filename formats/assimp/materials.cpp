// Assimp's materials as glTF materials: base colour and one image.
#include <assimp/GltfMaterial.h>
#include <assimp/material.h>

#include <cmath>
#include <filesystem>
#include <optional>
#include <system_error>

#include "formats/assimp/import.h"
#include "formats/files/file_kind.h"
#include "formats/mesh/triangle_mesh.h"

namespace mdk {
namespace {

namespace fs = std::filesystem;

bool is_file(const std::optional<std::string>& path) {
  std::error_code ignored;
  return path && fs::is_regular_file(*path, ignored);
}

std::string percent_encoded(const std::string& name) {
  constexpr char kDigits[] = "0123456789ABCDEF";
  std::string out;
  for (const char c : name) {
    const bool is_plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                          (c >= '0' && c <= '9') || c == '.' || c == '-' || c == '_' || c == '/';
    if (is_plain) {
      out.push_back(c);
    } else {
      const auto byte = static_cast<unsigned char>(c);
      out.append(1, '%').append(1, kDigits[byte >> 4]).append(1, kDigits[byte & 15]);
    }
  }
  return out;
}

class MaterialImport {
 public:
  explicit MaterialImport(SceneImport& import) : import_(import) {
    is_linear_ = file_kind(import.path) == FileKind::kGltf;
  }

  void run() {
    for (unsigned m = 0; m < import_.scene.mNumMaterials; ++m)
      import_.glb.add("materials", material(*import_.scene.mMaterials[m]));
  }

 private:
  Json material(const aiMaterial& from) {
    Json pbr;
    bool is_there = false;
    if (const std::optional<Json> texture = texture_of(from, is_there))
      pbr["baseColorTexture"] = *texture;
    if (is_there) return {{"pbrMetallicRoughness", pbr}};
    aiColor4D color(0.8f, 0.8f, 0.8f, 1.0f);
    if (from.Get(AI_MATKEY_BASE_COLOR, color) != aiReturn_SUCCESS)
      from.Get(AI_MATKEY_COLOR_DIFFUSE, color);
    for (unsigned c = 0; c < 3; ++c) {
      const double channel = static_cast<double>(color[c]);
      pbr["baseColorFactor"].push_back(
          is_linear_ ? std::clamp(std::isfinite(channel) ? channel : 0.0, 0.0, 1.0)
                     : linear_channel(channel));
    }
    pbr["baseColorFactor"].push_back(1);
    return {{"pbrMetallicRoughness", pbr}};
  }

  /// `is_there`: whether its image is; it then stands in place of the colour.
  std::optional<Json> texture_of(const aiMaterial& from, bool& is_there) {
    aiTextureType type = aiTextureType_BASE_COLOR;
    aiString name;
    if (from.Get(AI_MATKEY_TEXTURE(type, 0), name) != aiReturn_SUCCESS) {
      type = aiTextureType_DIFFUSE;
      if (from.Get(AI_MATKEY_TEXTURE(type, 0), name) != aiReturn_SUCCESS) return std::nullopt;
    }
    const Image image = image_of(name);
    if (!image.number) return std::nullopt;
    is_there = image.is_there;
    int modes[2] = {aiTextureMapMode_Wrap, aiTextureMapMode_Wrap}, set = 0;
    from.Get(AI_MATKEY_MAPPINGMODE_U(type, 0), modes[0]);
    from.Get(AI_MATKEY_MAPPINGMODE_V(type, 0), modes[1]);
    from.Get(AI_MATKEY_UVWSRC(type, 0), set);
    const auto wrap = [](int mode) {
      return mode == aiTextureMapMode_Mirror                                    ? 33648
             : mode == aiTextureMapMode_Clamp || mode == aiTextureMapMode_Decal ? 33071
                                                                                : 10497;
    };
    const std::size_t sampler =
        import_.glb.add("samplers", {{"wrapS", wrap(modes[0])}, {"wrapT", wrap(modes[1])}});
    const std::size_t texture =
        import_.glb.add("textures", {{"source", *image.number}, {"sampler", sampler}});
    return Json{{"index", texture},
                {"texCoord", set >= 0 && set < AI_MAX_NUMBER_OF_TEXTURECOORDS ? set : 0}};
  }

  struct Image {
    std::optional<std::size_t> number;
    bool is_there = false;
  };

  Image image_of(const aiString& name) {
    const auto [known, is_new] = images_.try_emplace(name.C_Str());
    if (is_new) {
      const aiTexture* embedded = import_.scene.GetEmbeddedTexture(name.C_Str());
      known->second = embedded != nullptr ? add_embedded(*embedded, name) : add_named(name);
    }
    return known->second;
  }

  Image add_embedded(const aiTexture& texture, const aiString& name) {
    if (texture.mHeight != 0 || texture.mWidth == 0 || texture.pcData == nullptr) {
      import_.note("the image " + quoted_name(name) +
                   " in it is no PNG or JPEG; the plain base colour is shown");
      return {};
    }
    const std::size_t view = import_.glb.add_bytes(
        {reinterpret_cast<const unsigned char*>(texture.pcData), texture.mWidth});
    return {import_.glb.add("images", {{"bufferView", view}, {"mimeType", "image/png"}}), true};
  }

  /// Where its name says or, since exporters write paths of the machine they ran on, where the last
  /// part of it says.
  Image add_named(const aiString& name) {
    std::string path(name.C_Str());
    std::ranges::replace(path, '\\', '/');
    const std::string last = fs::path(path).filename().string();
    if (!neighbor_path(import_.path, path) ||
        (!is_file(neighbor_path(import_.path, path)) && is_file(neighbor_path(import_.path, last))))
      path = last;
    if (path.empty()) return {};
    return {import_.glb.add("images", {{"uri", percent_encoded(path)}}),
            is_file(neighbor_path(import_.path, path))};
  }

  SceneImport& import_;
  bool is_linear_ = false;
  std::map<std::string, Image> images_;  ///< by name
};

}  // namespace

void add_materials(SceneImport& import) { MaterialImport(import).run(); }

}  // namespace mdk
