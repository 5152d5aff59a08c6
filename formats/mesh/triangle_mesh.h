// TriangleMesh: one pose of a mesh, and the readers of the files that hold one: .obj and .ply.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/motion/pose_sequence.h"

namespace mdk {

inline constexpr std::size_t kMaxMeshVertices = std::size_t{1} << 27;
inline constexpr std::size_t kMaxMeshTriangles = (std::size_t{1} << 29) / 3;

/// How the faces of an .obj refer to what an .mtl describes.
struct MaterialUse {
  std::vector<std::string> libraries;    ///< as each mtllib names them
  std::vector<std::string> names;        ///< those used; "" before the first usemtl
  std::vector<std::uint32_t> triangles;  ///< per triangle, index into `names`
  std::vector<TexCoord> corners;         ///< 3 per triangle, or none where the file has none
  bool is_missing_texcoords = false;     ///< some corners have none, and (0, 0) in their place
};

struct TriangleMesh {
  std::vector<Vec3f> vertices;
  std::vector<Triangle> triangles;
  /// Per vertex, linear RGBA, 8 bits each, red lowest; empty where no vertex has a colour.
  std::vector<std::uint32_t> vertex_colors;
  MaterialUse materials;  ///< of .obj files, where asked for
};

/// An sRGB channel, clamped to [0, 1] (NaN: 0), as linear light.
inline double linear_channel(double srgb) {
  const double s = std::min(std::max(0.0, srgb), 1.0);
  return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
}

/// An sRGB colour as opaque linear RGBA, red lowest.
inline std::uint32_t linear_color(const Vec3f& srgb) {
  std::uint32_t color = 0xff000000u;
  for (std::size_t i = 0; i < 3; ++i) {
    const double linear = linear_channel(static_cast<double>(srgb[i]));
    color |= static_cast<std::uint32_t>(std::lround(linear * 255)) << (8 * i);
  }
  return color;
}

/// What of an .obj is read.
enum class ObjContent {
  kShape,              ///< vertices, their colours, faces
  kShapeAndMaterials,  ///< which material each face and which texture coordinate each corner names
};

/// Reads vertices and faces; a polygon becomes a fan about its first corner, so that the same faces
/// always give the same triangles, wherever the vertices are. Colours after the coordinates
/// ("v x y z r g b") are taken as sRGB. Texture coordinates that are broken or missing are (0, 0).
/// `path` is for messages. Throws Error: kBadInput (broken, with the line), kOverLimit. Memory is
/// bounded by a small multiple of the text's size.
TriangleMesh parse_obj(const std::string& path, std::string_view text, ObjContent content);

/// Reads a .ply (text, or binary of either byte order): the elements "vertex" (x y z; red green
/// blue as sRGB) and "face" (vertex_indices); all others are skipped. Polygons as in parse_obj.
/// Throws Error: kBadInput (broken, with the place), kOverLimit. Memory is bounded by a small
/// multiple of the file's size, whatever its header promises.
TriangleMesh parse_ply(const std::string& path, std::string_view file);

/// Reads a file whose name ends in .ply as such, any other as .obj. Throws what these throw; kIo
/// where it cannot be read.
TriangleMesh read_mesh(const std::string& path, ObjContent content);

}  // namespace mdk
