#include "formats/gltf_compression_check.h"

#include <algorithm>
#include <map>
#include <utility>

#include "common/base/error.h"
#include "formats/gltf_draco.h"
#include "formats/gltf_meshopt.h"

namespace mdk::gltf {
namespace {

// Meshopt's densest code is a quarter of a byte for sixteen bytes.
constexpr std::size_t kMostBytesPerMeshoptByte = 64;
constexpr std::size_t kMaxDecodedBytes = std::size_t{4} << 30;

class CompressionCheck : private JsonCheck {
 public:
  using JsonCheck::JsonCheck;

  Compression run() {
    find_empty_buffers();
    const Json* views = array(root(), "the file", "bufferViews", Need::kOptional);
    for (std::size_t v = 0; views && v < views->size(); ++v) buffer_view((*views)[v], v);
    const Json* meshes = array(root(), "the file", "meshes", Need::kOptional);
    for (std::size_t m = 0; meshes && m < meshes->size(); ++m)
      for (std::size_t p = 0; p < (*meshes)[m]["primitives"].size(); ++p)
        primitive((*meshes)[m]["primitives"][p], m, p);
    return std::move(found_);
  }

 private:
  const Json* extension(const Json& o, const std::string& at, const char* name) const {
    const Json* all = object(o, at, "extensions", Need::kOptional);
    return all ? object(*all, at, name, Need::kOptional) : nullptr;
  }

  [[noreturn]] void no_decoder(const std::string& at, const char* name, const char* package) const {
    fail(at, std::string("needs the extension ") + name +
                 ", which this build has no decoder for; build it where " + package +
                 " is installed, or export the file without compression");
  }

  bool is_empty(std::size_t buffer) const {
    return std::ranges::find(found_.empty_buffers, buffer) != found_.empty_buffers.end();
  }

  void find_empty_buffers() {
    const Json* buffers = array(root(), "the file", "buffers", Need::kOptional);
    for (std::size_t b = 0; buffers && b < buffers->size(); ++b) {
      const std::string at = "buffer " + std::to_string(b);
      const Json* e = extension((*buffers)[b], at, "EXT_meshopt_compression");
      if (!e) continue;
      boolean(*e, at, "fallback");
      if (!e->value("fallback", false)) continue;
      if (can_decode_meshopt())
        found_.empty_buffers.push_back(b);
      else if (!(*buffers)[b].contains("uri"))
        no_decoder(at, "EXT_meshopt_compression", "libmeshoptimizer-dev");
    }
  }

  void buffer_view(const Json& o, std::size_t v) {
    const std::string at = "buffer view " + std::to_string(v);
    const Json* e = extension(o, at, "EXT_meshopt_compression");
    if (!e || !can_decode_meshopt()) {
      if (is_empty(o["buffer"].get<std::size_t>())) fail(at, "lies in a buffer without data");
      return;
    }
    MeshoptView view;
    view.view = v;
    view.data = meshopt_range(*e, at);
    view.count = size(*e, at, "count", Need::kRequired);
    view.stride = size(*e, at, "byteStride", Need::kRequired);
    view.mode = mode_of(*e, at);
    view.filter = filter_of(*e, at);
    check_shape(view, at);
    const std::size_t decoded = view.count * view.stride;  // at most 2^53 * 2^8
    if (decoded != o["byteLength"].get<std::size_t>())
      fail(at, "decodes to another length than its byteLength");
    if (decoded / kMostBytesPerMeshoptByte > view.data.size)
      fail(at, "promises " + std::to_string(decoded) + " bytes, more than its " +
                   std::to_string(view.data.size) + " compressed ones can hold");
    if (decoded > kMaxDecodedBytes - std::exchange(decoded_bytes_, decoded_bytes_ + decoded))
      throw Error(ErrorCode::kOverLimit, at + " takes what is decoded over 4 GiB; split the file");
    found_.views.push_back(view);
  }

  ByteRange meshopt_range(const Json& e, const std::string& at) const {
    index(e, at, "buffer", "buffers", Need::kRequired);
    ByteRange range;
    range.buffer = e["buffer"].get<std::size_t>();
    range.offset = size(e, at, "byteOffset", Need::kOptional);
    range.size = size(e, at, "byteLength", Need::kRequired);
    const auto available = root()["buffers"][range.buffer]["byteLength"].get<std::size_t>();
    if (range.size == 0 || range.offset > available || range.size > available - range.offset)
      fail(at, "reaches outside the buffer it is compressed in");
    if (is_empty(range.buffer)) fail(at, "is compressed in a buffer without data");
    return range;
  }

  MeshoptMode mode_of(const Json& e, const std::string& at) const {
    string(e, at, "mode", Need::kRequired);
    const std::string& mode = e["mode"].get_ref<const std::string&>();
    if (mode == "ATTRIBUTES") return MeshoptMode::kAttributes;
    if (mode == "TRIANGLES") return MeshoptMode::kTriangles;
    if (mode == "INDICES") return MeshoptMode::kIndices;
    fail(at, "has an unknown compression mode");
  }

  MeshoptFilter filter_of(const Json& e, const std::string& at) const {
    string(e, at, "filter", Need::kOptional);
    const std::string filter = e.value("filter", "NONE");
    if (filter == "NONE") return MeshoptFilter::kPlain;
    if (filter == "OCTAHEDRAL") return MeshoptFilter::kOctahedral;
    if (filter == "QUATERNION") return MeshoptFilter::kQuaternion;
    if (filter == "EXPONENTIAL") return MeshoptFilter::kExponential;
    fail(at, "has an unknown compression filter");
  }

  void check_shape(const MeshoptView& view, const std::string& at) const {
    const std::size_t stride = view.stride;
    bool fits = view.count > 0;
    if (view.mode == MeshoptMode::kAttributes) {
      fits &= stride > 0 && stride <= 256 && stride % 4 == 0;
      if (view.filter == MeshoptFilter::kOctahedral) fits &= stride == 4 || stride == 8;
      if (view.filter == MeshoptFilter::kQuaternion) fits &= stride == 8;
    } else {
      fits &= (stride == 2 || stride == 4) && view.filter == MeshoptFilter::kPlain;
      if (view.mode == MeshoptMode::kTriangles) fits &= view.count % 3 == 0;
    }
    if (!fits) fail(at, "has a count or byteStride that its compression cannot have");
  }

  void primitive(const Json& o, std::size_t mesh, std::size_t number) {
    DracoPrimitive primitive{mesh, number, {}, 0, {}};
    const std::string at = primitive.place();
    const Json* e = extension(o, at, "KHR_draco_mesh_compression");
    if (!e) return;
    if (!can_decode_draco()) return require_plain_copy(o, at);
    if (o.value("mode", 4) != 4)
      fail(at, "is compressed by Draco but is no list of triangles; export it as triangles");
    if (!o.contains("indices")) fail(at, "is compressed by Draco but has no index list");
    primitive.indices = o["indices"].get<std::size_t>();
    primitive.data = draco_range(*e, at);
    for (const auto& [name, id] : object(*e, at, "attributes", Need::kRequired)->items()) {
      if (!id.is_number_unsigned() || id.get<std::uint64_t>() > 0x7fffffff)
        fail(at, "has a Draco attribute whose id is no whole number");
      const Json& plain = o["attributes"];
      if (!plain.contains(name))
        fail(at, "has a Draco attribute that is none of the primitive's own");
      primitive.attributes.push_back({plain[name].get<std::size_t>(), id.get<std::uint32_t>()});
      claim(plain[name].get<std::size_t>(), {primitive.data.offset, id.get<std::size_t>()}, at);
    }
    claim(primitive.indices, {primitive.data.offset, kIndexList}, at);
    found_.primitives.push_back(std::move(primitive));
  }

  /// Primitives may share an accessor only where they share its data.
  void claim(std::size_t accessor, std::pair<std::size_t, std::size_t> data,
             const std::string& at) {
    if (claimed_.try_emplace(accessor, data).first->second != data)
      fail(at, "shares accessor " + std::to_string(accessor) + " with other Draco data");
  }

  ByteRange draco_range(const Json& e, const std::string& at) const {
    index(e, at, "bufferView", "bufferViews", Need::kRequired);
    const Json& view = root()["bufferViews"][e["bufferView"].get<std::size_t>()];
    const ByteRange range{view["buffer"].get<std::size_t>(),
                          view.value("byteOffset", std::size_t{0}),
                          view["byteLength"].get<std::size_t>()};
    if (is_empty(range.buffer)) fail(at, "is compressed twice, which cannot be read");
    return range;
  }

  void require_plain_copy(const Json& o, const std::string& at) const {
    const auto is_plain = [&](const Json& accessor) {
      return root()["accessors"][accessor.get<std::size_t>()].contains("bufferView");
    };
    bool plain = !o.contains("indices") || is_plain(o["indices"]);
    for (const Json& accessor : o["attributes"]) plain &= is_plain(accessor);
    if (!plain) no_decoder(at, "KHR_draco_mesh_compression", "libdraco-dev");
  }

  static constexpr std::size_t kIndexList = ~std::size_t{0};

  std::map<std::size_t, std::pair<std::size_t, std::size_t>> claimed_;  ///< by accessor
  std::size_t decoded_bytes_ = 0;
  Compression found_;
};

}  // namespace

Compression check_compression(const std::string& file, const Json& root) {
  return CompressionCheck(file, root).run();
}

void hide_compression(const Compression& compression, Json& root) {
  for (const std::size_t b : compression.empty_buffers)
    root["buffers"][b] = {{"byteLength", 1}, {"uri", "data:application/octet-stream;base64,AA=="}};
  for (const DracoPrimitive& p : compression.primitives)
    root["meshes"][p.mesh]["primitives"][p.primitive].erase("indices");
}

}  // namespace mdk::gltf
