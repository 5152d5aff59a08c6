// Reads a Wavefront .obj as plain triangles: one pose of a mesh.
#pragma once

#include <string>
#include <string_view>

#include "formats/triangle_mesh.h"

namespace mdk {

enum class ObjContent {
  kShape,              ///< vertices, their colours, faces
  kShapeAndMaterials,  ///< which material each face and which texture coordinate each corner names
};

/// Reads vertices and faces; a polygon becomes a fan about its first corner, so that the same faces
/// always give the same triangles, wherever the vertices are. Colours after the coordinates
/// ("v x y z r g b") are taken as sRGB. Texture coordinates that are broken or missing are (0, 0).
/// Throws Error: kIo (cannot read), kBadInput (broken, with the line), kOverLimit. Memory is
/// bounded by a small multiple of the file's size.
TriangleMesh read_obj(const std::string& path, ObjContent content);

/// The same for a text in memory; `path` is for messages alone.
TriangleMesh parse_obj(const std::string& path, std::string_view text, ObjContent content);

}  // namespace mdk
