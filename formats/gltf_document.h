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
#include "formats/gltf_files.h"
#include "formats/gltf_quaternion.h"

namespace mdk::gltf {

/// No such thing, where an index could stand.
inline constexpr int kNone = -1;

enum class ComponentType : std::uint8_t { kInt8, kUint8, kInt16, kUint16, kUint32, kFloat32 };

/// `count` elements of `components` numbers each. Every byte that it reaches exists.
struct Accessor {
  const unsigned char* data = nullptr;  ///< null: every element is zero
  std::size_t count = 0;                ///< at least one
  std::size_t stride = 0;               ///< bytes from one element to the next
  int components = 1;                   ///< 1, 2, 3, 4, 9 or 16
  ComponentType type = ComponentType::kFloat32;
  bool normalized = false;

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

/// Sentences about what is left out: each once, in the order they came up.
class Notes {
 public:
  void add(const std::string& sentence);
  const std::vector<std::string>& sentences() const { return sentences_; }

 private:
  std::vector<std::string> sentences_;
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
  std::vector<Bytes> embedded_images;
  std::vector<Bytes> decoded;     ///< buffer views and accessors that are compressed in the file
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
  std::vector<std::string> dependencies;  ///< every file read so far
  std::vector<std::string> unread;        ///< images that could not be read
};

/// Reads and checks `path` and its buffers; images are left to whoever shows them. Throws Error as
/// read_gltf does.
Document load_document(const std::string& path, Notes& notes);

/// The same for the bytes of a .gltf or .glb that stand, or would stand, at `path`, which is not
/// among the dependencies.
Document parse_document(const std::string& path, Bytes bytes, Notes& notes);

}  // namespace mdk::gltf
