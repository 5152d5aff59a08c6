// Draco and meshoptimizer: what they decode is checked against what the properties promise.
#include <cstring>
#include <memory>
#include <optional>
#include <utility>

#include "common/base/error.h"
#include "formats/gltf/compression.h"

#ifdef MDK_HAVE_DRACO
#include <draco/compression/decode.h>
#endif
#ifdef MDK_HAVE_MESHOPT
#include <meshoptimizer.h>
#endif

namespace mdk::gltf {

#ifdef MDK_HAVE_DRACO
namespace {

// Real meshes take a bit or more for a face; even a perfect grid takes an eighth of one.
constexpr std::uint64_t kMaxFacesPerByte = 64;

constexpr std::size_t kMaxDecodedBytes = std::size_t{4} << 30;

/// What the head of a Draco mesh promises.
struct DracoCounts {
  std::uint64_t faces = 0, vertices = 0;
};

/// "DRACO" | major | minor | 1: mesh | method | u16 flags, then, for edgebreaker (1), a traversal
/// and the varints vertices, faces; for sequential (0) the varints faces, points.
class DracoHead {
 public:
  explicit DracoHead(std::span<const unsigned char> bytes) : rest_(bytes) {}

  /// Nothing where it is no mesh of the one version that glTF has, or has metadata before it.
  std::optional<DracoCounts> read() {
    constexpr std::size_t kFixedBytes = 11;
    constexpr unsigned char kStart[] = {'D', 'R', 'A', 'C', 'O', 2, 2, 1};
    if (rest_.size() < kFixedBytes || std::memcmp(rest_.data(), kStart, sizeof kStart) != 0)
      return std::nullopt;
    const unsigned method = rest_[8];
    const bool has_metadata = rest_[9] != 0 || rest_[10] != 0;
    if (method > 1 || has_metadata) return std::nullopt;
    rest_ = rest_.subspan(kFixedBytes);
    if (method == 1 && !rest_.empty()) rest_ = rest_.subspan(1);
    const std::optional<std::uint64_t> a = varint(), b = varint();
    if (!a || !b) return std::nullopt;
    return method == 1 ? DracoCounts{*b, *a} : DracoCounts{*a, *b};
  }

 private:
  std::optional<std::uint64_t> varint() {
    std::uint64_t value = 0;
    for (unsigned shift = 0; shift < 35 && !rest_.empty(); shift += 7) {
      const unsigned char byte = rest_.front();
      rest_ = rest_.subspan(1);
      value |= std::uint64_t{byte & 0x7fu} << shift;
      if (byte < 0x80) return value;
    }
    return std::nullopt;
  }

  std::span<const unsigned char> rest_;
};

class DracoPrimitiveDecoder {
 public:
  DracoPrimitiveDecoder(const DracoPrimitive& primitive, Document& document)
      : primitive_(primitive), document_(document) {}

  void decode(std::span<const unsigned char> compressed) {
    check_head(compressed);
    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char*>(compressed.data()), compressed.size());
    draco::Decoder decoder;
    auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
    if (!decoded.ok()) fail("has broken Draco data");
    const std::unique_ptr<draco::Mesh> mesh = std::move(decoded).value();
    copy_faces(*mesh);
    for (const DracoAttribute& attribute : primitive_.attributes) copy_attribute(*mesh, attribute);
  }

 private:
  [[noreturn]] void fail(const std::string& sentence) const {
    throw bad_input(document_.path, primitive_.place + " " + sentence);
  }

  void check_head(std::span<const unsigned char> compressed) const {
    const std::optional<DracoCounts> counts = DracoHead(compressed).read();
    if (!counts)
      fail("has Draco data that is no plain mesh of version 2.2; export it again without Draco");
    if (counts->faces > kMaxFacesPerByte * compressed.size())
      fail("promises " + std::to_string(counts->faces) + " faces, more than its " +
           std::to_string(compressed.size()) + " compressed bytes can hold");
    bool fits = counts->faces * 3 == document_.accessors[primitive_.indices].count;
    for (const DracoAttribute& attribute : primitive_.attributes)
      fits &= counts->vertices <= document_.accessors[attribute.accessor].count;
    if (!fits) fail_to_match();
  }

  [[noreturn]] void fail_to_match() const {
    fail("has Draco data of other counts or components than its accessors");
  }

  void copy_faces(const draco::Mesh& mesh) {
    Accessor& a = document_.accessors[primitive_.indices];
    if (std::uint64_t{mesh.num_faces()} * 3 != a.count || a.components != 1) fail_to_match();
    a.type = ComponentType::kUint32;
    unsigned char* out = give_bytes(a);
    for (draco::FaceIndex f(0); f < mesh.num_faces(); ++f) {
      for (std::size_t c = 0; c < 3; ++c) {
        const std::uint32_t corner = mesh.face(f)[c].value();
        std::memcpy(out, &corner, sizeof corner);
        out += sizeof corner;
      }
    }
  }

  void copy_attribute(const draco::Mesh& mesh, const DracoAttribute& from) {
    const draco::PointAttribute* attribute = mesh.GetAttributeByUniqueId(from.id);
    Accessor& a = document_.accessors[from.accessor];
    if (!attribute || mesh.num_points() != a.count || attribute->num_components() != a.components)
      fail_to_match();
    switch (a.type) {
      case ComponentType::kInt8:
        return copy_numbers<std::int8_t>(*attribute, a);
      case ComponentType::kUint8:
        return copy_numbers<std::uint8_t>(*attribute, a);
      case ComponentType::kInt16:
        return copy_numbers<std::int16_t>(*attribute, a);
      case ComponentType::kUint16:
        return copy_numbers<std::uint16_t>(*attribute, a);
      case ComponentType::kUint32:
        return copy_numbers<std::uint32_t>(*attribute, a);
      default:
        return copy_numbers<float>(*attribute, a);
    }
  }

  template <class T>
  void copy_numbers(const draco::PointAttribute& attribute, Accessor& a) {
    constexpr int kMaxComponents = 16;
    unsigned char* out = give_bytes(a);
    for (std::size_t i = 0; i < a.count; ++i, out += a.stride) {
      const auto point = draco::PointIndex(static_cast<std::uint32_t>(i));
      const draco::AttributeValueIndex value = attribute.mapped_index(point);
      T numbers[kMaxComponents] = {};
      if (value.value() >= attribute.size() ||
          !attribute.ConvertValue<T>(value, static_cast<std::int8_t>(a.components), numbers))
        fail("has a Draco attribute that does not fit its accessor's type");
      std::memcpy(out, numbers, a.stride);
    }
  }

  /// Room for all of the accessor's elements, instead of whatever it pointed at.
  unsigned char* give_bytes(Accessor& a) {
    a.stride = component_bytes(a.type) * static_cast<std::size_t>(a.components);
    document_.decoded_bytes += a.count * a.stride;
    if (document_.decoded_bytes > kMaxDecodedBytes)
      throw Error(ErrorCode::kOverLimit,
                  document_.path + ": its Draco meshes take over 4 GiB; split it");
    Bytes& bytes = document_.decoded.emplace_back(a.count * a.stride);
    a.data = bytes.data();
    return bytes.data();
  }

  const DracoPrimitive& primitive_;
  Document& document_;
};

}  // namespace

bool can_decode_draco() { return true; }

void decode_draco(const DracoPrimitive& primitive, std::span<const unsigned char> compressed,
                  Document& document) {
  DracoPrimitiveDecoder(primitive, document).decode(compressed);
}

#else

bool can_decode_draco() { return false; }

void decode_draco(const DracoPrimitive& primitive, std::span<const unsigned char>,
                  Document& document) {
  throw Error(ErrorCode::kInternal, document.path + ": " + primitive.place + " has no decoder");
}

#endif

#ifdef MDK_HAVE_MESHOPT

bool can_decode_meshopt() { return true; }

Bytes decode_meshopt(const MeshoptView& view, std::span<const unsigned char> compressed) {
  Bytes bytes(view.count * view.stride);
  const auto decode = [&] {
    switch (view.mode) {
      case MeshoptMode::kAttributes:
        return meshopt_decodeVertexBuffer(bytes.data(), view.count, view.stride, compressed.data(),
                                          compressed.size());
      case MeshoptMode::kTriangles:
        return meshopt_decodeIndexBuffer(bytes.data(), view.count, view.stride, compressed.data(),
                                         compressed.size());
      default:
        return meshopt_decodeIndexSequence(bytes.data(), view.count, view.stride, compressed.data(),
                                           compressed.size());
    }
  };
  if (decode() != 0) return {};
  if (view.filter == MeshoptFilter::kOctahedral)
    meshopt_decodeFilterOct(bytes.data(), view.count, view.stride);
  if (view.filter == MeshoptFilter::kQuaternion)
    meshopt_decodeFilterQuat(bytes.data(), view.count, view.stride);
  if (view.filter == MeshoptFilter::kExponential)
    meshopt_decodeFilterExp(bytes.data(), view.count, view.stride);
  return bytes;
}

#else

bool can_decode_meshopt() { return false; }

Bytes decode_meshopt(const MeshoptView&, std::span<const unsigned char>) { return {}; }

#endif

}  // namespace mdk::gltf
