// The properties of a glTF file's JSON, checked, before any of the bytes they promise is read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "formats/gltf/document.h"

namespace mdk::gltf {

struct BufferSource {
  std::string uri;  ///< as written; empty: the binary chunk of a .glb
  std::size_t bytes = 0;
  bool is_empty = false;  ///< stands for what meshopt views decode to, without data
};

/// Bytes of a buffer; they exist if the buffer is as long as it says.
struct ByteRange {
  std::size_t buffer = 0;
  std::size_t offset = 0;
  std::size_t size = 0;
};

struct ViewSource {
  ByteRange range;
  std::size_t stride = 0;  ///< 0: elements are tightly packed
};

/// Where an accessor's numbers stand.
struct ElementSource {
  int view = kNone;
  std::size_t offset = 0;
};

struct AccessorSource {
  ElementSource elements;
  ElementSource sparse_indices, sparse_values;  ///< where the accessor is sparse
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
  ByteRange data;
  std::size_t indices = 0;  ///< accessor
  std::vector<DracoAttribute> attributes;
};

struct Properties {
  std::vector<BufferSource> buffers;
  std::vector<ViewSource> views;
  std::vector<AccessorSource> accessors;  ///< as many as the document's
  std::vector<int> image_views;           ///< per image of the document; kNone: it has a URI
  std::vector<MeshoptView> meshopt_views;
  std::vector<DracoPrimitive> draco_primitives;
  std::optional<std::vector<int>>
      scene;  ///< roots of the default one; none where no scene is there
};

/// Fills in `document` what its path's JSON says of accessors, meshes, nodes, skins, animations,
/// materials and images, and adds notes to `result`. Afterwards every index is in range, every
/// buffer view lies inside its buffer's length, and every required extension is known. Throws Error
/// (kBadInput) naming the place, kOverLimit. Cost: one parse.
Properties read_properties(std::string_view json, Document& document, ReadResult& result);

}  // namespace mdk::gltf
