// What a glTF file's JSON must look like before anything else reads it. tinygltf takes a property
// of the wrong type for an absent one, checks few indices, and recurses without a limit; here every
// property that is used has its type, every index points at something, and nesting is bounded.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "formats/gltf/document.h"

namespace mdk::gltf {

struct BufferSource {
  std::string uri;  ///< as written, still percent-encoded; empty: the binary chunk of a .glb
  std::size_t bytes = 0;
  bool is_empty = false;  ///< stands for what meshopt views decode to, without data

  bool is_file() const { return !is_empty && !uri.empty() && !uri.starts_with("data:"); }
};

/// Bytes of a buffer; they exist if the buffer is as long as it says.
struct ByteRange {
  std::size_t buffer = 0;
  std::size_t offset = 0;
  std::size_t size = 0;
};

enum class MeshoptMode { kAttributes, kTriangles, kIndices };
enum class MeshoptFilter { kPlain, kOctahedral, kQuaternion, kExponential };

/// A buffer view with EXT_meshopt_compression: `count` elements of `stride` bytes, of sizes that
/// its mode and filter allow and `data` may hold.
struct MeshoptView {
  std::size_t view = 0;
  ByteRange data;
  std::size_t count = 0;
  std::size_t stride = 0;
  MeshoptMode mode = MeshoptMode::kAttributes;
  MeshoptFilter filter = MeshoptFilter::kPlain;
};

struct DracoAttribute {
  std::size_t accessor = 0;
  std::uint32_t id = 0;  ///< the attribute's unique id in the Draco mesh
};

/// A primitive with KHR_draco_mesh_compression.
struct DracoPrimitive {
  std::string place;  ///< "mesh 0, primitive 1"
  std::size_t mesh = 0, primitive = 0;
  ByteRange data;
  std::size_t indices = 0;  ///< accessor
  std::vector<DracoAttribute> attributes;
};

struct Schema {
  std::vector<BufferSource> buffers;
  std::vector<ByteRange> views;
  std::vector<int> accessor_views;  ///< per accessor: where its elements stand, or kNone
  std::vector<MeshoptView> meshopt_views;
  std::vector<DracoPrimitive> draco_primitives;
  std::string plain_json;  ///< what knows no compression is to read instead; empty: the file's own
};

/// Checks the JSON text of `file` (for messages). Afterwards every property that is used has its
/// type, every index is in range, every buffer view lies inside its buffer's length, and every
/// required extension is known. Adds a note for each of the others. Throws Error (kBadInput) naming
/// the place, kOverLimit. Cost: one parse.
Schema check_schema(const std::string& file, std::string_view json,
                    std::vector<std::string>& notes);

}  // namespace mdk::gltf
