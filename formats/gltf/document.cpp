// Everything that tinygltf hands over is turned into checked structs here, and what is compressed
// is decoded. The schema check before it has settled types and indices.
#include "formats/gltf/document.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "common/base/error.h"
#include "formats/gltf/compression.h"
#include "formats/gltf/links.h"
#include "formats/gltf/parse.h"
#include "formats/gltf/schema.h"

namespace mdk::gltf {
namespace {

// An accessor without bytes is free to claim any length, so its length has a limit of its own.
constexpr std::size_t kMaxZeroElements = std::size_t{1} << 24;

class Converter {
 public:
  Converter(tinygltf::Model& model, const Schema& schema, Document& document)
      : model_(model), schema_(schema), document_(document) {}

  void run() {
    for (tinygltf::Buffer& buffer : model_.buffers)
      document_.buffers.push_back(std::move(buffer.data));
    decode_views();
    for (std::size_t i = 0; i < model_.accessors.size(); ++i) convert_accessor(i);
    for (std::size_t i = 0; i < model_.meshes.size(); ++i) convert_mesh(i);
    decode_primitives();
    convert_nodes();
    for (const tinygltf::Skin& skin : model_.skins)
      document_.skins.push_back({skin.joints, skin.inverseBindMatrices});
    for (std::size_t i = 0; i < model_.animations.size(); ++i) convert_animation(i);
    for (tinygltf::Image& image : model_.images) convert_image(image);
    for (const tinygltf::Material& material : model_.materials) convert_material(material);
    check_links(document_);
  }

 private:
  std::span<const unsigned char> view_bytes(int view) const {
    const auto decoded = decoded_views_.find(static_cast<std::size_t>(view));
    if (decoded != decoded_views_.end()) return decoded->second;
    const tinygltf::BufferView& v = entry(model_.bufferViews, view);
    return range_bytes({static_cast<std::size_t>(v.buffer), v.byteOffset, v.byteLength});
  }

  std::span<const unsigned char> range_bytes(const ByteRange& range) const {
    return std::span<const unsigned char>(document_.buffers[range.buffer])
        .subspan(range.offset, range.size);
  }

  void decode_views() {
    for (const MeshoptView& view : schema_.meshopt_views) {
      document_.decoded.push_back(decode_meshopt(view, range_bytes(view.data)));
      if (document_.decoded.back().empty())
        fail(document_, "buffer view", view.view, "has broken meshopt data");
      decoded_views_[view.view] = document_.decoded.back();
    }
  }

  /// Their index lists were hidden from tinygltf, which refuses those without a buffer view.
  void decode_primitives() {
    for (const DracoPrimitive& primitive : schema_.draco_primitives) {
      document_.meshes[primitive.mesh].primitives[primitive.primitive].indices =
          static_cast<int>(primitive.indices);
      decode_draco(primitive, range_bytes(primitive.data), document_);
    }
  }

  ComponentType component_type(int type, std::size_t accessor) const {
    switch (type) {
      case TINYGLTF_COMPONENT_TYPE_BYTE:
        return ComponentType::kInt8;
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return ComponentType::kUint8;
      case TINYGLTF_COMPONENT_TYPE_SHORT:
        return ComponentType::kInt16;
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return ComponentType::kUint16;
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        return ComponentType::kUint32;
      case TINYGLTF_COMPONENT_TYPE_FLOAT:
        return ComponentType::kFloat32;
      default:
        fail(document_, "accessor", accessor, "has an unknown componentType");
    }
  }

  void convert_accessor(std::size_t i) {
    const tinygltf::Accessor& from = model_.accessors[i];
    Accessor a;
    a.count = from.count;
    a.type = component_type(from.componentType, i);
    a.components = tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(from.type));
    a.normalized = from.normalized;
    const std::size_t element = a.element_bytes();
    a.stride = element;
    if (from.bufferView >= 0) {
      const std::span<const unsigned char> bytes = view_bytes(from.bufferView);
      const std::size_t stride = entry(model_.bufferViews, from.bufferView).byteStride;
      if (stride != 0) a.stride = stride;
      if (a.stride < element)
        fail(document_, "accessor", i, "has elements wider than their stride");
      if (from.byteOffset > bytes.size() || element > bytes.size() - from.byteOffset ||
          a.count - 1 > (bytes.size() - from.byteOffset - element) / a.stride)
        fail(document_, "accessor", i, "reaches past its buffer view");
      a.data = bytes.data() + from.byteOffset;
    } else if (a.count > kMaxZeroElements) {
      fail(document_, "accessor", i, "has no data for " + std::to_string(a.count) + " elements");
    }
    if (from.sparse.isSparse) convert_sparse(from, i, a);
    document_.accessors.push_back(a);
  }

  void convert_sparse(const tinygltf::Accessor& from, std::size_t i, Accessor& a) const {
    a.sparse_count = static_cast<std::size_t>(from.sparse.count);
    a.sparse_index_type = component_type(from.sparse.indices.componentType, i);
    if (a.sparse_count > a.count)
      fail(document_, "accessor", i, "replaces more elements than it has");
    if (!is_unsigned(a.sparse_index_type))
      fail(document_, "accessor", i, "has sparse indices that are not unsigned integers");
    const auto part = [&](int view, int offset, std::size_t width) {
      const std::span<const unsigned char> bytes = view_bytes(view);
      const auto start = static_cast<std::size_t>(offset);
      if (start > bytes.size() || a.sparse_count > (bytes.size() - start) / width)
        fail(document_, "accessor", i, "has sparse data that reaches past its buffer view");
      return bytes.data() + start;
    };
    a.sparse_indices = part(from.sparse.indices.bufferView, from.sparse.indices.byteOffset,
                            component_bytes(a.sparse_index_type));
    a.sparse_values =
        part(from.sparse.values.bufferView, from.sparse.values.byteOffset, a.element_bytes());
  }

  void convert_mesh(std::size_t m) {
    const tinygltf::Mesh& from = model_.meshes[m];
    Mesh mesh;
    mesh.weights = from.weights;
    for (const tinygltf::Primitive& p : from.primitives) {
      mesh.primitives.push_back(convert_primitive(p, m));
      if (from.weights.empty()) mesh.weights.resize(mesh.primitives[0].target_offsets.size(), 0.0);
    }
    document_.meshes.push_back(std::move(mesh));
  }

  Primitive convert_primitive(const tinygltf::Primitive& from, std::size_t mesh) const {
    const auto role = [](const std::map<std::string, int>& attributes, const std::string& name) {
      const auto it = attributes.find(name);
      return it == attributes.end() ? kNone : it->second;
    };
    const auto sets = [&](const std::string& name) {
      std::vector<int> all;
      for (int a; (a = role(from.attributes, name + std::to_string(all.size()))) != kNone;)
        all.push_back(a);
      return all;
    };
    Primitive p;
    p.mode = static_cast<PrimitiveMode>(from.mode);
    p.indices = from.indices;
    p.material = from.material;
    p.positions = role(from.attributes, "POSITION");
    p.normals = role(from.attributes, "NORMAL");
    p.colors = role(from.attributes, "COLOR_0");
    p.texcoords = sets("TEXCOORD_");
    p.joints = sets("JOINTS_");
    p.weights = sets("WEIGHTS_");
    if (p.joints.size() != p.weights.size())
      fail(document_, "mesh", mesh, "has joints without weights or weights without joints");
    for (const auto& target : from.targets) p.target_offsets.push_back(role(target, "POSITION"));
    return p;
  }

  void convert_nodes() {
    for (std::size_t i = 0; i < model_.nodes.size(); ++i) {
      const tinygltf::Node& from = model_.nodes[i];
      Node node;
      node.name = from.name;
      node.children = from.children;
      node.mesh = from.mesh;
      node.skin = from.skin;
      node.weights = from.weights;
      if (node.mesh != kNone && node.weights.empty())
        node.weights = entry(document_.meshes, node.mesh).weights;
      const auto vector = [](const std::vector<double>& v) { return Vec3d{v[0], v[1], v[2]}; };
      const std::vector<double>& q = from.rotation;
      if (!from.translation.empty()) node.translation = vector(from.translation);
      if (!from.scale.empty()) node.scale = vector(from.scale);
      if (!q.empty()) node.rotation = normalized(Quaternion{q[0], q[1], q[2], q[3]});
      if (!from.matrix.empty()) convert_matrix(from.matrix, i, node);
      document_.nodes.push_back(std::move(node));
    }
    order_nodes(document_);
    find_visible_nodes(document_, scene_roots());
  }

  void convert_matrix(const std::vector<double>& columns, std::size_t number, Node& node) const {
    constexpr double kTolerance = 1e-4;
    const double last_row[4] = {columns[3], columns[7], columns[11], columns[15] - 1};
    for (double entry : last_row)
      if (!(std::abs(entry) < kTolerance))
        fail(document_, "node", number, "has a matrix with perspective");
    node.has_matrix = true;
    for (std::size_t row = 0; row < 3; ++row)
      for (std::size_t column = 0; column < 4; ++column)
        node.matrix.m[row][column] = columns[column * 4 + row];
  }

  std::vector<int> scene_roots() const {
    if (!model_.scenes.empty()) return entry(model_.scenes, std::max(0, model_.defaultScene)).nodes;
    std::vector<int> roots;
    for (std::size_t i = 0; i < document_.nodes.size(); ++i)
      if (document_.nodes[i].parent == kNone) roots.push_back(static_cast<int>(i));
    return roots;
  }

  /// Channels that move nothing known (an extension's, or without a node) are dropped.
  void convert_animation(std::size_t number) {
    const tinygltf::Animation& from = model_.animations[number];
    Animation animation{from.name, {}};
    for (const tinygltf::AnimationChannel& c : from.channels) {
      const tinygltf::AnimationSampler& sampler = entry(from.samplers, c.sampler);
      Channel channel;
      channel.node = c.target_node;
      channel.input = sampler.input;
      channel.output = sampler.output;
      if (c.target_path == "translation")
        channel.path = TrackPath::kTranslation;
      else if (c.target_path == "rotation")
        channel.path = TrackPath::kRotation;
      else if (c.target_path == "scale")
        channel.path = TrackPath::kScale;
      else if (c.target_path == "weights")
        channel.path = TrackPath::kWeights;
      else
        continue;
      if (sampler.interpolation == "STEP")
        channel.interpolation = Interpolation::kStep;
      else if (sampler.interpolation == "CUBICSPLINE")
        channel.interpolation = Interpolation::kCubicSpline;
      else if (sampler.interpolation != "LINEAR")
        fail(document_, "animation", number, "has an unknown interpolation");
      if (channel.node != kNone) animation.channels.push_back(channel);
    }
    document_.animations.push_back(std::move(animation));
  }

  void convert_image(tinygltf::Image& from) {
    ImageSource image;
    image.uri = from.uri;
    if (from.bufferView >= 0) image.bytes = view_bytes(from.bufferView);
    if (!from.image.empty()) {
      document_.decoded.push_back(std::move(from.image));
      image.bytes = document_.decoded.back();
    }
    document_.images.push_back(std::move(image));
  }

  void convert_material(const tinygltf::Material& from) {
    MaterialSource material;
    const tinygltf::PbrMetallicRoughness& pbr = from.pbrMetallicRoughness;
    for (std::size_t i = 0; i < 4; ++i)
      material.material.base_color[i] =
          static_cast<float>(std::clamp(pbr.baseColorFactor[i], 0.0, 1.0));
    if (from.extensions.contains("KHR_materials_unlit")) material.material.flags = kMaterialUnlit;
    if (pbr.baseColorTexture.index >= 0) {
      const tinygltf::Texture& texture = entry(model_.textures, pbr.baseColorTexture.index);
      material.image = texture.source;
      material.texcoord_set = pbr.baseColorTexture.texCoord;
      if (texture.sampler >= 0) {
        const auto& sampler = entry(model_.samplers, texture.sampler);
        material.material.wrap_u = wrap(sampler.wrapS);
        material.material.wrap_v = wrap(sampler.wrapT);
      }
      convert_texture_transform(pbr.baseColorTexture, material);
    }
    document_.materials.push_back(material);
  }

  static TextureWrap wrap(int mode) {
    if (mode == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE) return TextureWrap::kClamp;
    if (mode == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT) return TextureWrap::kMirror;
    return TextureWrap::kRepeat;
  }

  /// Offset after rotation after scale. v points down, so counter-clockwise is (u, v) -> (v, -u).
  static void convert_texture_transform(const tinygltf::TextureInfo& info,
                                        MaterialSource& material) {
    const auto it = info.extensions.find("KHR_texture_transform");
    if (it == info.extensions.end()) return;
    const tinygltf::Value& transform = it->second;
    const auto pair_or = [&](const char* key, double fallback) {
      std::pair<double, double> p{fallback, fallback};
      if (transform.Has(key)) {
        p.first = transform.Get(key).Get(0).GetNumberAsDouble();
        p.second = transform.Get(key).Get(1).GetNumberAsDouble();
      }
      return p;
    };
    const auto [offset_u, offset_v] = pair_or("offset", 0);
    const auto [scale_u, scale_v] = pair_or("scale", 1);
    const double angle =
        transform.Has("rotation") ? transform.Get("rotation").GetNumberAsDouble() : 0.0;
    const double c = std::cos(angle), s = std::sin(angle);
    material.u_row = {c * scale_u, s * scale_v, offset_u};
    material.v_row = {-s * scale_u, c * scale_v, offset_v};
    if (transform.Has("texCoord"))
      material.texcoord_set = transform.Get("texCoord").GetNumberAsInt();
  }

  tinygltf::Model& model_;
  const Schema& schema_;
  Document& document_;
  std::map<std::size_t, std::span<const unsigned char>> decoded_views_;
};

}  // namespace

void fail(const Document& document, const char* what, std::size_t number,
          const std::string& sentence) {
  throw bad_input(document.path, what + (" " + std::to_string(number)) + " " + sentence);
}

Document parse_document(const std::string& path, const Bytes& bytes, ReadResult& result) {
  Document document;
  document.path = path;
  const Schema schema = check_schema(path, json_text(path, bytes), result.notes);
  tinygltf::Model model = parse_gltf(path, bytes, schema, result.dependencies);
  Converter(model, schema, document).run();
  return document;
}

}  // namespace mdk::gltf
