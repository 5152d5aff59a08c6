// Appearance: what a mesh looks like, apart from where it is. Kept per triangle and per corner, so
// that vertices may be shared wherever they move together.
#pragma once

#include <cstdint>
#include <vector>

namespace mdk {

inline constexpr std::uint32_t kNoTexture = 0xffffffffu;

enum class TextureWrap : std::uint32_t { kRepeat = 0, kClamp = 1, kMirror = 2 };

enum MaterialFlags : std::uint32_t {
  kMaterialFlatShaded = 1u << 0,  ///< the source gives no normals: every triangle is its own facet
  kMaterialUnlit = 1u << 1,       ///< shown in its base colour, without light
  kMaterialKnownFlags = kMaterialFlatShaded | kMaterialUnlit,
};

/// 32 bytes, as the file holds it.
struct Material {
  float base_color[4] = {0.8f, 0.8f, 0.8f, 1.0f};  ///< linear RGBA, each in [0, 1]
  std::uint32_t texture = kNoTexture;              ///< index into the textures, or kNoTexture
  std::uint32_t flags = 0;                         ///< MaterialFlags
  TextureWrap wrap_u = TextureWrap::kRepeat;
  TextureWrap wrap_v = TextureWrap::kRepeat;

  bool operator==(const Material&) const = default;
};

/// 16 bytes: an image of `width` x `height` texels, row 0 on top, from `first_texel` in the texels.
struct Texture {
  std::uint32_t width = 0, height = 0;
  std::uint64_t first_texel = 0;
};

struct TexCoord {
  float u = 0, v = 0;  ///< glTF convention: (0, 0) is the upper left corner of the image
};

/// One display description of a mesh with T triangles. The corner lists are empty where no triangle
/// has such data; otherwise corner c of triangle t stands at 3 t + c.
struct Appearance {
  std::vector<Material> materials;                ///< at least one
  std::vector<std::uint32_t> triangle_materials;  ///< T
  std::vector<TexCoord> corner_texcoords;         ///< 0 or 3 T
  std::vector<std::uint32_t> corner_colors;  ///< 0 or 3 T: linear RGBA, 8 bits each, red lowest
  std::vector<Texture> textures;
  std::vector<std::uint32_t> texels;  ///< sRGB RGBA, 8 bits each, red lowest
};

}  // namespace mdk
