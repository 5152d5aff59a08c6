// Primitives, decoded: what a mesh is before any pose. A mesh shown by several nodes is decoded
// once.
#pragma once

#include <cstdint>
#include <vector>

#include "common/math/vec3.h"
#include "common/motion/pose_sequence.h"
#include "formats/gltf/document.h"

namespace mdk::gltf {

struct Influence {
  std::uint32_t joint = 0;  ///< index into the skin's joints
  double weight = 0;        ///< above zero
};

/// V vertices.
struct PrimitiveGeometry {
  int material = kNone;
  bool has_normals = false;
  std::vector<Vec3f> positions;                    ///< V
  std::vector<std::uint64_t> smoothing_groups;     ///< V: the normal's hash; 0 without normals
  std::vector<Triangle> triangles;                 ///< as in the file, strips and fans unrolled
  std::vector<std::vector<Vec3f>> target_offsets;  ///< per morph target: V, or none for no change

  /// Vertex i has influences [first_influence[i], first_influence[i + 1]); their weights sum to
  /// one, or there are none. Empty where the primitive has no joints.
  std::vector<std::uint32_t> first_influence;  ///< V + 1
  std::vector<Influence> influences;
  std::uint32_t joint_count = 0;  ///< how many joints a skin must have

  std::vector<TexCoord> texcoords;    ///< V or none: transformed, of the base colour's set
  std::vector<std::uint32_t> colors;  ///< V or none: linear RGBA, red lowest
};

struct MeshGeometry {
  std::vector<PrimitiveGeometry> primitives;  ///< those that have triangles
};

/// What is left out becomes notes. Throws Error (kBadInput) naming mesh and primitive.
MeshGeometry read_mesh(const Document& document, int mesh, std::vector<std::string>& notes);

}  // namespace mdk::gltf
