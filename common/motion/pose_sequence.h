// PoseSequence: one fixed triangle list and key poses of its vertices (docs/method.md, words).
// What readers make and what the decomposition takes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/base/scratch.h"
#include "common/math/vec3.h"
#include "common/motion/arrays.h"
#include "common/motion/rig.h"

namespace mdk {

struct Triangle {
  std::uint32_t v[3] = {0, 0, 0};  ///< vertex indices, counter-clockwise seen from outside

  bool operator==(const Triangle&) const = default;
};

/// A run of keys that are played together. Poses are interpolated between the keys of one clip,
/// never from one clip to the next.
struct Clip {
  std::string name;
  std::uint32_t first_key = 0;
  std::uint32_t key_count = 0;  ///< at least one

  bool operator==(const Clip&) const = default;
};

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

/// How a mesh of T triangles looks, apart from where it is: kept per triangle and per corner, so
/// that vertices may be shared wherever they move together. The corner arrays are empty where no
/// triangle has such data; otherwise corner c of triangle t stands at 3 t + c.
template <template <class> class List>
struct AppearanceLists {
  List<Material> materials;                ///< at least one
  List<std::uint32_t> triangle_materials;  ///< T
  List<TexCoord> corner_texcoords;         ///< 0 or 3 T
  List<std::uint32_t> corner_colors;       ///< 0 or 3 T: linear RGBA, 8 bits each, red lowest
  List<Texture> textures;
  List<std::uint32_t> texels;  ///< sRGB RGBA, 8 bits each, red lowest

  /// See RigLists.
  template <class Visit, class... Looks>
  static void for_each_array(Visit&& visit, Looks&... looks) {
    using enum Count;
    using namespace count_rules;
    visit(array_row("MATL", "materials", some()), looks.materials...);
    visit(array_row("TMAT", "triangle_materials", exactly(kTriangles)),
          looks.triangle_materials...);
    visit(array_row("UVCO", "corner_texcoords", none_or(kCorners)), looks.corner_texcoords...);
    visit(array_row("COLR", "corner_colors", none_or(kCorners)), looks.corner_colors...);
    visit(array_row("TEXI", "textures", some(0)), looks.textures...);
    visit(array_row("TEXL", "texels", any()), looks.texels...);
  }

  /// Valid while this lives and is not changed.
  AppearanceLists<ConstSpan> view() const {
    AppearanceLists<ConstSpan> look;
    for_each_array(kAssign, look, *this);
    return look;
  }
};
using Appearance = AppearanceLists<OwnedList>;

/// Positions at all keys: what a long animation takes most room for, and so may stand in a file.
using PositionList = ScratchList<Vec3f>;

struct PoseSequence {
  std::uint32_t vertex_count = 0;
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> triangle_meshes;  ///< per triangle, the mesh of the source it is of,
                                               ///< from 0 without gaps; empty where there is one
  std::vector<Clip> clips;                     ///< contiguous, in key order, covering every key
  std::vector<double> key_times;  ///< per key: seconds from its clip's start, rising within a clip
  PositionList positions;         ///< key-major: vertex i at key k stands at k * vertex_count + i
  std::optional<Rig> rig;         ///< what the positions were decoded from, bit for bit
  std::optional<Skeleton> skeleton;  ///< what the rig's bones hang on
  Appearance appearance;

  std::uint32_t key_count() const { return static_cast<std::uint32_t>(key_times.size()); }
  std::span<const Vec3f> pose(std::uint32_t key) const {
    return {positions.data() + static_cast<std::size_t>(key) * vertex_count, vertex_count};
  }
  std::span<Vec3f> pose(std::uint32_t key) {
    return {positions.data() + static_cast<std::size_t>(key) * vertex_count, vertex_count};
  }
};

/// Drops vertices no triangle uses and joins vertices that have the same path through all keys and
/// the same `smoothing_group`; keeps the order of first use. Triangles keep their corners' order,
/// so corner attributes stay valid. `smoothing_groups`: one per vertex, or empty for "all alike".
/// With a rig, the same path is one computed from the same numbers, and positions may still be
/// missing. Cost: O(vertices * keys), with a rig O(vertices log vertices).
void weld_vertices(PoseSequence& sequence, std::span<const std::uint64_t> smoothing_groups);

/// Keeps the vertices `kept`, in that order, and renumbers the triangles, all of whose corners must
/// be kept. No vertex may stand in `kept` twice. Cost: O(kept * keys).
void select_vertices(PoseSequence& sequence, std::span<const std::uint32_t> kept);

/// Decodes the positions of a sequence that has a rig.
void decode_positions(PoseSequence& sequence);

/// What is wrong with the parts that sequences and models have in common: a sentence that begins
/// with the name of an array, or nothing. Cost: a pass over them, but not over the values of
/// texture coordinates, colours and texels.
std::string clip_fault(std::span<const Clip> clips, std::span<const double> key_times);
std::string triangle_fault(std::span<const Triangle> triangles, std::uint32_t vertex_count);
std::string appearance_fault(const AppearanceLists<ConstSpan>& look, std::uint64_t triangles);

/// Throws std::logic_error where the parts do not fit together (a reader's bug, never a user's).
void check_consistency(const PoseSequence& sequence);

/// Per vertex the lowest vertex of the same group and with exactly the same path through all keys
/// (-0 equals 0). `groups`: one per vertex, or empty for "all alike". `hashes`: one per vertex,
/// equal for what is the same; they only save comparisons. Runs in parallel. Cost:
/// O(vertices * keys), once more for each round of hash collisions.
std::vector<std::uint32_t> lowest_equal_paths(const PoseSequence& sequence,
                                              std::span<const std::uint64_t> groups,
                                              std::span<const std::uint64_t> hashes);

}  // namespace mdk
