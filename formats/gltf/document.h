// A glTF file as plain, checked structs: what the rest of the reader works on. tinygltf ends here.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/math/affine3.h"
#include "common/math/vec3.h"
#include "common/motion/pose_sequence.h"
#include "formats/gltf/files.h"
#include "formats/gltf/quaternion.h"
#include "formats/reading.h"

namespace mdk::gltf {

/// No such thing, where an index could stand.
inline constexpr int kNone = -1;

/// What an index of the file, which is not kNone, leads to.
template <class List>
auto& entry(List& list, int index) {
  return list[static_cast<std::size_t>(index)];
}

enum class ComponentType : std::uint8_t { kInt8, kUint8, kInt16, kUint16, kUint32, kFloat32 };

/// Bytes of one number.
std::size_t component_bytes(ComponentType type);
bool is_unsigned(ComponentType type);

/// `count` elements of `components` numbers each. Every byte that it reaches exists.
struct Accessor {
  const unsigned char* data = nullptr;  ///< null: every element is zero
  std::size_t count = 0;                ///< at least one
  std::size_t stride = 0;               ///< bytes from one element to the next
  int components = 1;                   ///< 1, 2, 3, 4, 9 or 16
  ComponentType type = ComponentType::kFloat32;
  bool normalized = false;

  std::size_t element_bytes() const {
    return component_bytes(type) * static_cast<std::size_t>(components);
  }

  /// Elements that are replaced: `sparse_count` rising indices, and as many tightly packed
  /// elements.
  std::size_t sparse_count = 0;
  const unsigned char* sparse_indices = nullptr;
  ComponentType sparse_index_type = ComponentType::kUint32;
  const unsigned char* sparse_values = nullptr;
};

enum class PrimitiveMode { kPoints, kLines, kLineLoop, kLineStrip, kTriangles, kStrip, kFan };

/// Accessors by their role; kNone where there is none.
struct Primitive {
  PrimitiveMode mode = PrimitiveMode::kTriangles;
  int indices = kNone;
  int material = kNone;
  int positions = kNone;
  int normals = kNone;
  int colors = kNone;
  std::vector<int> texcoords;       ///< by set
  std::vector<int> joints;          ///< by set; as many as weights
  std::vector<int> weights;         ///< by set
  std::vector<int> target_offsets;  ///< per morph target: its POSITION
};

struct Mesh {
  std::vector<Primitive> primitives;  ///< all with `weights.size()` morph targets
  std::vector<double> weights;        ///< per morph target
};

struct Node {
  std::string name;
  int parent = kNone;
  std::vector<int> children;
  int mesh = kNone;
  int skin = kNone;
  bool has_matrix = false;  ///< `matrix` counts, and no animation may move it
  Affine3d matrix;
  Vec3d translation;
  Quaternion rotation;  ///< of length one
  Vec3d scale{1, 1, 1};
  std::vector<double> weights;  ///< per morph target of the mesh: its own, or the mesh's
};

struct Skin {
  std::vector<int> joints;  ///< nodes
  int inverse_bind_matrices = kNone;
};

enum class Interpolation { kLinear, kStep, kCubicSpline };
enum class TrackPath { kTranslation, kRotation, kScale, kWeights };

struct Channel {
  int node = kNone;
  TrackPath path = TrackPath::kTranslation;
  int input = kNone;   ///< accessor of times
  int output = kNone;  ///< accessor of values
  Interpolation interpolation = Interpolation::kLinear;
};

struct Animation {
  std::string name;  ///< may be empty
  std::vector<Channel> channels;
};

struct MaterialSource {
  Material material;     ///< without texture index and flags but kMaterialUnlit
  int image = kNone;     ///< base colour
  int texcoord_set = 0;  ///< which TEXCOORD_n it is looked up by
  Vec3d u_row{1, 0, 0};  ///< u' = u_row · (u, v, 1), from KHR_texture_transform
  Vec3d v_row{0, 1, 0};
};

struct ImageSource {
  std::span<const unsigned char> bytes;  ///< encoded; empty: see `uri`
  std::string uri;                       ///< relative to the file's folder
};

/// Owns the bytes that its accessors and images point at.
struct Document {
  Document() = default;
  Document(Document&&) = default;
  Document& operator=(Document&&) = default;
  Document(const Document&) = delete;
  Document& operator=(const Document&) = delete;

  std::string path;
  std::vector<Bytes> buffers;
  std::vector<Bytes> decoded;     ///< what is compressed in the file, and images in data URIs
  std::size_t decoded_bytes = 0;  ///< by Draco, so far
  std::vector<Accessor> accessors;
  std::vector<Mesh> meshes;
  std::vector<Node> nodes;
  std::vector<int> node_order;     ///< all nodes, parents before children
  std::vector<int> visible_nodes;  ///< those of the default scene that show a mesh, by number
  std::vector<Skin> skins;
  std::vector<Animation> animations;
  std::vector<MaterialSource> materials;
  std::vector<ImageSource> images;
};

/// Reads and checks the bytes of a .gltf or .glb that stand, or would stand, at `path`, and buffers
/// beside it; images are left to those who show them. What is read and left out is added to
/// `result`. Throws Error as read_gltf does.
Document parse_document(const std::string& path, const Bytes& bytes, ReadResult& result);

/// Throws Error (kBadInput): "accessor 3 reaches past its buffer view".
[[noreturn]] void fail(const Document& document, const char* what, std::size_t number,
                       const std::string& sentence);

/// All numbers of an accessor, element after element: count * components. Normalised integers
/// become [0, 1] or [-1, 1], other integers their value. Throws Error (kBadInput) for a number that
/// is not finite.
std::vector<float> read_floats(const Document& document, int accessor);

/// The same for unsigned integers. Throws Error (kBadInput) for signed, float or normalised ones.
std::vector<std::uint32_t> read_unsigned(const Document& document, int accessor);

/// The accessor, if it has `components` numbers an element. Throws Error (kBadInput) naming `place`
/// ("mesh 0, primitive 1: NORMAL") otherwise.
const Accessor& expect_components(const Document& document, int accessor, int components,
                                  const std::string& place);

}  // namespace mdk::gltf
