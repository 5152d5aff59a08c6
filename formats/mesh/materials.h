// What the materials of an .obj look like: base colours and textures, from the .mtl files it names.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/motion/pose_sequence.h"
#include "formats/mesh/triangle_mesh.h"
#include "formats/reading.h"

namespace mdk {

struct MtlMaterial {
  std::string name;
  Material material;   ///< base colour: Kd, taken as sRGB; white where there is a texture
  std::string map_kd;  ///< file name of the texture, as written; empty without one
};

/// The materials of an .mtl text, in its order. Nothing in it is refused: what cannot be read, or
/// is neither Kd nor map_Kd, is left out, numbers and options of map_Kd with a note.
std::vector<MtlMaterial> parse_mtl(const std::string& path, std::string_view text,
                                   std::vector<std::string>& notes);

/// Colours, materials and textures of `mesh`, which `obj_path` holds. A material, file or image
/// that is missing, broken or not in the folder becomes a note and plain grey, or the plain base
/// colour. Files read, files that could not be read, and notes are appended to those of `result`.
Appearance read_appearance(const std::string& obj_path, const TriangleMesh& mesh,
                           ReadResult& result);

}  // namespace mdk
