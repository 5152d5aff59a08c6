// What a glTF file has compressed: plain lists, checked before anything is decoded.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace mdk::gltf {

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
  std::size_t mesh = 0;
  std::size_t primitive = 0;
  ByteRange data;
  std::size_t indices = 0;  ///< accessor
  std::vector<DracoAttribute> attributes;

  /// "mesh 0, primitive 1"
  std::string place() const {
    return "mesh " + std::to_string(mesh) + ", primitive " + std::to_string(primitive);
  }
};

struct Compression {
  std::vector<MeshoptView> views;
  std::vector<DracoPrimitive> primitives;
  std::vector<std::size_t> empty_buffers;  ///< that stand for what `views` decode to, without data

  bool is_used() const { return !views.empty() || !primitives.empty() || !empty_buffers.empty(); }
};

}  // namespace mdk::gltf
