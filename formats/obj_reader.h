// Reads a Wavefront .obj as plain triangles: the mesh that a point cache moves.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/motion/pose_sequence.h"

namespace mdk {

struct ObjMesh {
  std::vector<Vec3f> vertices;
  std::vector<Triangle> triangles;
  /// Per vertex, linear RGBA, 8 bits each, red lowest; empty where no vertex has a colour.
  std::vector<std::uint32_t> vertex_colors;
  std::vector<std::string> notes;  ///< one sentence per thing left out
};

/// Reads vertices and faces; a polygon becomes a fan about its first corner, so that the same faces
/// always give the same triangles, wherever the vertices are. Colours after the coordinates
/// ("v x y z r g b") are taken as sRGB. Throws Error: kIo (cannot read), kBadInput (broken, with
/// the line), kOverLimit. Memory is bounded by a small multiple of the file's size.
ObjMesh read_obj(const std::string& path);

}  // namespace mdk
