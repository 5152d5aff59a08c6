#include "formats/gltf/compression.h"

#include <string>
#include <utility>

#include "common/base/error.h"
#include "formats/gltf/json.h"

namespace mdk::gltf {
namespace {

// Meshopt's densest code is a quarter of a byte for sixteen bytes.
constexpr std::size_t kMaxBytesPerMeshoptByte = 64;
constexpr std::size_t kMaxDecodedBytes = std::size_t{4} << 30;
constexpr std::size_t kIndexList = ~std::size_t{0};  // in the place of an attribute's id
constexpr std::size_t kTriangleList = 4;

[[noreturn]] void no_decoder(const JsonObject& o, const char* name, const char* package) {
  o.fail(std::string("needs the extension ") + name +
         ", which this build has no decoder for; build it where " + package +
         " is installed, or export the file without compression");
}

MeshoptMode mode_of(const JsonObject& extension) {
  const std::string mode = extension.string("mode", Need::kRequired);
  if (mode == "ATTRIBUTES") return MeshoptMode::kAttributes;
  if (mode == "TRIANGLES") return MeshoptMode::kTriangles;
  if (mode == "INDICES") return MeshoptMode::kIndices;
  extension.fail("has an unknown compression mode");
}

MeshoptFilter filter_of(const JsonObject& extension) {
  const std::string filter = extension.string("filter", Need::kOptional);
  if (!extension.has("filter") || filter == "NONE") return MeshoptFilter::kPlain;
  if (filter == "OCTAHEDRAL") return MeshoptFilter::kOctahedral;
  if (filter == "QUATERNION") return MeshoptFilter::kQuaternion;
  if (filter == "EXPONENTIAL") return MeshoptFilter::kExponential;
  extension.fail("has an unknown compression filter");
}

bool is_possible(const MeshoptView& view) {
  const std::size_t stride = view.stride;
  if (view.count == 0) return false;
  if (view.mode == MeshoptMode::kAttributes) {
    if (view.filter == MeshoptFilter::kOctahedral) return stride == 4 || stride == 8;
    if (view.filter == MeshoptFilter::kQuaternion) return stride == 8;
    return stride > 0 && stride <= 256 && stride % 4 == 0;
  }
  return (stride == 2 || stride == 4) && view.filter == MeshoptFilter::kPlain &&
         (view.mode != MeshoptMode::kTriangles || view.count % 3 == 0);
}

}  // namespace

bool CompressionCheck::is_empty_buffer(const JsonObject& buffer) const {
  const auto extension = buffer.extension("EXT_meshopt_compression");
  if (!extension || !extension->boolean("fallback")) return false;
  if (can_decode_meshopt()) return true;
  if (!buffer.has("uri")) no_decoder(buffer, "EXT_meshopt_compression", "libmeshoptimizer-dev");
  return false;
}

void CompressionCheck::add_view(const JsonObject& o) {
  const ByteRange& plain = schema_.views.back();
  const auto extension = o.extension("EXT_meshopt_compression");
  if (!extension || !can_decode_meshopt()) {
    if (schema_.buffers[plain.buffer].is_empty) o.fail("lies in a buffer without data");
    return;
  }
  MeshoptView view;
  view.view = schema_.views.size() - 1;
  view.data = meshopt_range(*extension);
  view.count = extension->size("count", Need::kRequired);
  view.stride = extension->size("byteStride", Need::kRequired);
  view.mode = mode_of(*extension);
  view.filter = filter_of(*extension);
  if (!is_possible(view)) o.fail("has a count or byteStride that its compression cannot have");
  const std::size_t decoded = view.count * view.stride;  // at most 2^53 * 2^8
  if (decoded != plain.size) o.fail("decodes to another length than its byteLength");
  if (decoded / kMaxBytesPerMeshoptByte > view.data.size)
    o.fail("promises " + std::to_string(decoded) + " bytes, more than its " +
           std::to_string(view.data.size) + " compressed ones can hold");
  if (decoded > kMaxDecodedBytes - std::exchange(decoded_bytes_, decoded_bytes_ + decoded))
    throw Error(ErrorCode::kOverLimit,
                o.place() + " takes what is decoded over 4 GiB; split the file");
  schema_.meshopt_views.push_back(view);
}

ByteRange CompressionCheck::meshopt_range(const JsonObject& extension) const {
  ByteRange range;
  range.buffer = static_cast<std::size_t>(extension.index("buffer", "buffers", Need::kRequired));
  range.offset = extension.size("byteOffset", Need::kOptional);
  range.size = extension.size("byteLength", Need::kRequired);
  const BufferSource& buffer = schema_.buffers[range.buffer];
  if (range.size == 0 || range.offset > buffer.bytes || range.size > buffer.bytes - range.offset)
    extension.fail("reaches outside the buffer it is compressed in");
  if (buffer.is_empty) extension.fail("is compressed in a buffer without data");
  return range;
}

void CompressionCheck::add_primitive(const JsonObject& o, const JsonObject& attributes,
                                     std::size_t mesh, std::size_t number) {
  const auto extension = o.extension("KHR_draco_mesh_compression");
  if (!extension) return;
  if (!can_decode_draco()) return require_plain_copy(o, attributes);
  if (o.has("mode") && o.size("mode", Need::kRequired) != kTriangleList)
    o.fail("is compressed by Draco but is no list of triangles; export it as triangles");
  if (!o.has("indices")) o.fail("is compressed by Draco but has no index list");
  DracoPrimitive primitive{o.place(), mesh, number, draco_range(*extension), 0, {}};
  primitive.indices = static_cast<std::size_t>(o.index("indices", "accessors", Need::kRequired));
  const JsonObject ids = *extension->object("attributes", Need::kRequired);
  for (const std::string& name : ids.keys()) {
    if (!ids.is_small_size(name.c_str()))
      o.fail("has a Draco attribute whose id is no whole number");
    const std::size_t id = ids.size(name.c_str(), Need::kRequired);
    if (!attributes.has(name.c_str()))
      o.fail("has a Draco attribute that is none of the primitive's own");
    const auto accessor =
        static_cast<std::size_t>(attributes.index(name.c_str(), "accessors", Need::kRequired));
    primitive.attributes.push_back({accessor, static_cast<std::uint32_t>(id)});
    claim(accessor, {primitive.data.offset, id}, o);
  }
  claim(primitive.indices, {primitive.data.offset, kIndexList}, o);
  schema_.draco_primitives.push_back(std::move(primitive));
}

/// Primitives may share an accessor only where they share its data.
void CompressionCheck::claim(std::size_t accessor, std::pair<std::size_t, std::size_t> data,
                             const JsonObject& o) {
  if (claimed_.try_emplace(accessor, data).first->second != data)
    o.fail("shares accessor " + std::to_string(accessor) + " with other Draco data");
}

ByteRange CompressionCheck::draco_range(const JsonObject& extension) const {
  const int view = extension.index("bufferView", "bufferViews", Need::kRequired);
  const ByteRange& range = entry(schema_.views, view);
  if (schema_.buffers[range.buffer].is_empty)
    extension.fail("is compressed twice, which cannot be read");
  return range;
}

void CompressionCheck::require_plain_copy(const JsonObject& primitive,
                                          const JsonObject& attributes) const {
  const auto is_plain = [&](int accessor) {
    return accessor == kNone || entry(schema_.accessor_views, accessor) != kNone;
  };
  bool plain = is_plain(primitive.index("indices", "accessors", Need::kOptional));
  for (const std::string& name : attributes.keys())
    plain &= is_plain(attributes.index(name.c_str(), "accessors", Need::kRequired));
  if (!plain) no_decoder(primitive, "KHR_draco_mesh_compression", "libdraco-dev");
}

}  // namespace mdk::gltf
