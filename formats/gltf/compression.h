// Compressed glTF: KHR_draco_mesh_compression and EXT_meshopt_compression. First the properties,
// checked before anything is decoded, then the decoders, where their libraries were there at build
// time.
#pragma once

#include <cstddef>
#include <map>
#include <span>
#include <utility>

#include "formats/gltf/document.h"
#include "formats/gltf/schema.h"

namespace mdk::gltf {

class JsonObject;

/// Lists in `schema` what is compressed, while the rest is checked. Throws Error: kBadInput (a
/// property is wrong, sizes that the compressed bytes cannot hold, or what this build has no
/// decoder for and no plain copy of), kOverLimit (decodes to over 4 GiB).
class CompressionCheck {
 public:
  explicit CompressionCheck(Schema& schema) : schema_(schema) {}

  /// Whether a buffer has no data, because views that decode to it are compressed elsewhere.
  bool is_empty_buffer(const JsonObject& buffer) const;
  /// The last of the views so far; all buffers are known.
  void add_view(const JsonObject& view);
  /// All accessors are known.
  void add_primitive(const JsonObject& o, const JsonObject& attributes, std::size_t mesh,
                     std::size_t number);

 private:
  ByteRange meshopt_range(const JsonObject& extension) const;
  ByteRange draco_range(const JsonObject& extension) const;
  void claim(std::size_t accessor, std::pair<std::size_t, std::size_t> data, const JsonObject& o);
  void require_plain_copy(const JsonObject& primitive, const JsonObject& attributes) const;

  Schema& schema_;
  std::map<std::size_t, std::pair<std::size_t, std::size_t>> claimed_;  ///< by accessor: its data
  std::size_t decoded_bytes_ = 0;
};

bool can_decode_draco();
bool can_decode_meshopt();

/// Gives the primitive's accessors the data that `compressed` holds, as numbers of the types they
/// have (the index list: 32 bits). Before anything is decoded, the counts in Draco's header are
/// compared with the accessors' and with what so many bytes can hold. Throws Error (kBadInput).
void decode_draco(const DracoPrimitive& primitive, std::span<const unsigned char> compressed,
                  Document& document);

/// The view's bytes: count * stride. Empty where the data is broken (indices may still be out of
/// range: whoever uses them checks).
Bytes decode_meshopt(const MeshoptView& view, std::span<const unsigned char> compressed);

}  // namespace mdk::gltf
