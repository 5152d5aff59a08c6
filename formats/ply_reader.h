// Reads a .ply (text, or binary of either byte order) as plain triangles: one pose of a mesh.
#pragma once

#include <string>
#include <string_view>

#include "formats/triangle_mesh.h"

namespace mdk {

/// Reads the elements "vertex" (x y z; red green blue as sRGB) and "face" (vertex_indices), and
/// skips all others. A polygon becomes a fan about its first corner, as in read_obj. Throws Error:
/// kIo (cannot read), kBadInput (broken, with the place), kOverLimit. Memory is bounded by a small
/// multiple of the file's size, whatever its header promises.
TriangleMesh read_ply(const std::string& path);

/// The same for a file in memory; `path` is for messages alone.
TriangleMesh parse_ply(const std::string& path, std::string_view file);

}  // namespace mdk
