// Writes small animated scenes as binary glTF 2.0 (.glb), the same bytes for the same scene.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "assets/quaternion.h"
#include "common/math/vec3.h"

namespace mdk {

struct GlbMesh {
  std::string name;
  std::vector<Vec3d> positions, normals;              ///< metres; one normal per vertex
  std::vector<std::array<std::uint8_t, 4>> colors;    ///< linear RGBA; one per vertex
  std::vector<std::array<std::uint8_t, 4>> joints;    ///< empty where the mesh is not skinned
  std::vector<std::array<std::uint16_t, 4>> weights;  ///< of the joints; they sum to 65535
  std::vector<std::array<std::uint32_t, 3>> triangles;
  double roughness = 0.6;  ///< of its material, in [0, 1]
};

/// A node at rest, relative to its parent.
struct GlbNode {
  std::string name;
  int parent = -1;
  Vec3d translation;
  Quaternion rotation;
  int mesh = -1;  ///< drawn here, or -1
  int skin = -1;  ///< that moves the mesh, or -1
};

struct GlbSkin {
  std::vector<int> joints;                                    ///< nodes, the root first
  std::vector<std::array<double, 16>> inverse_bind_matrices;  ///< column by column
};

enum class GlbPath { kTranslation, kRotation, kScale };

/// What one node does in a clip: a value per time, 4 numbers (a quaternion) or 3.
struct GlbTrack {
  int node = 0;
  GlbPath path = GlbPath::kRotation;
  std::vector<std::array<double, 4>> values;
};

struct GlbClip {
  std::string name;
  std::vector<double> times;  ///< seconds, rising; values between are interpolated linearly
  std::vector<GlbTrack> tracks;
};

struct GlbScene {
  std::string copyright;
  std::vector<GlbNode> nodes;
  std::vector<GlbMesh> meshes;
  std::vector<GlbSkin> skins;
  std::vector<GlbClip> clips;
};

/// The scene as a .glb file's bytes. Numbers are rounded (positions to a micrometre, rotations and
/// normals to 1e-6) so that the last bits of a mathematical library leave no trace.
std::vector<std::uint8_t> encode_glb(const GlbScene& scene);

/// Writes `bytes` to `path`. Throws Error (kIo).
void write_bytes(const std::string& path, const std::vector<std::uint8_t>& bytes);

}  // namespace mdk
