// One member function per kind of glTF object, each reading the properties that are used.
#include "formats/gltf/properties.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "common/base/error.h"
#include "formats/files/notes.h"
#include "formats/gltf/compression.h"
#include "formats/gltf/json.h"

namespace mdk::gltf {
namespace {

constexpr std::size_t kMaxExtensionName = 60;  // characters of it in a sentence

struct KnownExtension {
  std::string_view name;
  std::string_view cure;  ///< empty: supported, or it only changes looks that are not shown
};

constexpr std::array kKnownExtensions = {
    KnownExtension{"KHR_mesh_quantization", ""},
    KnownExtension{"KHR_texture_transform", ""},
    KnownExtension{"KHR_materials_unlit", ""},
    KnownExtension{"KHR_lights_punctual", ""},
    KnownExtension{"KHR_texture_basisu", ""},
    KnownExtension{"EXT_texture_webp", ""},
    KnownExtension{"KHR_draco_mesh_compression",
                   "build this where libdraco-dev is installed, or export it again without Draco"},
    KnownExtension{"EXT_meshopt_compression",
                   "build this where libmeshoptimizer-dev is installed, or export it again without "
                   "meshopt compression"},
    KnownExtension{"EXT_mesh_gpu_instancing", "export it again with its instances as nodes"},
};

/// The KHR_materials_… family refines how a surface reflects light, never where it is.
bool is_known(const std::string& name) {
  if (name.starts_with("KHR_materials_")) return true;
  if (name == "KHR_draco_mesh_compression") return can_decode_draco();
  if (name == "EXT_meshopt_compression") return can_decode_meshopt();
  const auto it = std::ranges::find(kKnownExtensions, name, &KnownExtension::name);
  return it != kKnownExtensions.end() && it->cure.empty();
}

std::string cure_for(const std::string& name) {
  const auto it = std::ranges::find(kKnownExtensions, name, &KnownExtension::name);
  return it != kKnownExtensions.end() ? std::string(it->cure)
                                      : "export it again without this extension";
}

/// glTF's number for a type of numbers; nothing where there is none such.
std::optional<ComponentType> component_type(int number) {
  switch (number) {
    case 5120:
      return ComponentType::kInt8;
    case 5121:
      return ComponentType::kUint8;
    case 5122:
      return ComponentType::kInt16;
    case 5123:
      return ComponentType::kUint16;
    case 5125:
      return ComponentType::kUint32;
    case 5126:
      return ComponentType::kFloat32;
    default:
      return std::nullopt;
  }
}

int component_count(const JsonObject& accessor) {
  constexpr std::pair<std::string_view, int> kTypes[] = {
      {"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT2", 4}, {"MAT3", 9}, {"MAT4", 16}};
  const std::string type = accessor.string("type", Need::kRequired);
  for (const auto& [name, count] : kTypes)
    if (name == type) return count;
  accessor.fail("has an unknown type");
}

std::optional<TrackPath> track_path(const std::string& path) {
  if (path == "translation") return TrackPath::kTranslation;
  if (path == "rotation") return TrackPath::kRotation;
  if (path == "scale") return TrackPath::kScale;
  if (path == "weights") return TrackPath::kWeights;
  return std::nullopt;
}

std::optional<Interpolation> interpolation(const std::string& name) {
  if (name == "LINEAR") return Interpolation::kLinear;
  if (name == "STEP") return Interpolation::kStep;
  if (name == "CUBICSPLINE") return Interpolation::kCubicSpline;
  return std::nullopt;
}

TextureWrap texture_wrap(int number) {
  if (number == 33071) return TextureWrap::kClamp;
  if (number == 33648) return TextureWrap::kMirror;
  return TextureWrap::kRepeat;
}

struct TextureSource {
  int image = kNone;
  int sampler = kNone;
};

struct Sampler {
  TextureWrap wrap_u = TextureWrap::kRepeat, wrap_v = TextureWrap::kRepeat;
};

class PropertiesReader {
 public:
  PropertiesReader(const Json& json, Document& document, ReadResult& result)
      : root_(document.path, json, "the file", json), document_(document), result_(result) {}

  Properties read() {
    check_asset();
    check_extensions();
    each("buffers", "buffer", &PropertiesReader::read_buffer);
    each("bufferViews", "buffer view", &PropertiesReader::read_view);
    each("accessors", "accessor", &PropertiesReader::read_accessor);
    each("meshes", "mesh", &PropertiesReader::read_mesh);
    each("nodes", "node", &PropertiesReader::read_node);
    each("skins", "skin", &PropertiesReader::read_skin);
    each("animations", "animation", &PropertiesReader::read_animation);
    each("textures", "texture", &PropertiesReader::read_texture);
    each("samplers", "sampler", &PropertiesReader::read_sampler);
    each("materials", "material", &PropertiesReader::read_material);
    each("images", "image", &PropertiesReader::read_image);
    read_scenes();
    return std::move(properties_);
  }

 private:
  void each(const char* list, const std::string& what,
            void (PropertiesReader::*read_one)(const JsonObject&)) {
    for (const JsonObject& o : root_.objects(list, what, Need::kOptional)) (this->*read_one)(o);
  }

  void check_asset() const {
    const std::string version =
        root_.object("asset", Need::kRequired)->string("version", Need::kRequired);
    if (!version.starts_with("2."))
      root_.fail("is glTF " + version.substr(0, 20) + "; only glTF 2 can be read");
  }

  void check_extensions() {
    for (const auto& name : root_.strings("extensionsRequired")) {
      if (!name) root_.fail("has an \"extensionsRequired\" that is no string");
      if (!is_known(*name))
        root_.fail("needs the extension " + name->substr(0, kMaxExtensionName) +
                   ", which is not supported; " + cure_for(*name));
    }
    for (const auto& name : root_.strings("extensionsUsed"))
      if (name && !is_known(*name))
        add_note(result_.notes,
                 "the extension " + name->substr(0, kMaxExtensionName) + " is left out");
  }

  void read_buffer(const JsonObject& o) {
    BufferSource buffer;
    buffer.bytes = o.size("byteLength", Need::kRequired);
    if (buffer.bytes == 0) o.fail("is empty");
    buffer.uri = o.string("uri", Need::kOptional);
    if (o.has("uri") && buffer.uri.empty()) o.fail("has an empty uri");
    if (buffer.uri.starts_with("data:") &&
        !buffer.uri.starts_with("data:application/octet-stream;base64,") &&
        !buffer.uri.starts_with("data:application/gltf-buffer;base64,"))
      o.fail("has a data URI that is not base64 of application/octet-stream");
    buffer.is_empty = compression_.is_empty_buffer(o);
    properties_.buffers.push_back(std::move(buffer));
  }

  void read_view(const JsonObject& o) {
    ViewSource view;
    view.range.buffer = static_cast<std::size_t>(o.index("buffer", "buffers", Need::kRequired));
    view.range.offset = o.size("byteOffset", Need::kOptional);
    view.range.size = o.size("byteLength", Need::kRequired);
    const std::size_t available = properties_.buffers[view.range.buffer].bytes;
    if (view.range.size == 0 || view.range.offset > available ||
        view.range.size > available - view.range.offset)
      o.fail("reaches outside its buffer");
    view.stride = o.size("byteStride", Need::kOptional);
    if (o.has("byteStride") && (view.stride < 4 || view.stride > 252 || view.stride % 4 != 0))
      o.fail("has a byteStride that is not a multiple of 4 from 4 to 252");
    properties_.views.push_back(view);
    compression_.add_view(o);
  }

  void read_accessor(const JsonObject& o) {
    Accessor a;
    AccessorSource source;
    source.elements = {o.index("bufferView", "bufferViews", Need::kOptional),
                       o.size("byteOffset", Need::kOptional)};
    a.type = component_type_of(o);
    a.components = component_count(o);
    a.normalized = o.boolean("normalized");
    a.count = o.size("count", Need::kRequired);
    if (a.count == 0) o.fail("has no elements");
    if (const auto sparse = o.object("sparse", Need::kOptional)) {
      a.sparse_count = sparse->size("count", Need::kRequired);
      if (a.sparse_count > a.count) o.fail("replaces more elements than it has");
      const auto part = [&](const char* key) {
        const JsonObject p = *sparse->object(key, Need::kRequired);
        return ElementSource{p.index("bufferView", "bufferViews", Need::kRequired),
                             p.size("byteOffset", Need::kOptional)};
      };
      source.sparse_indices = part("indices");
      source.sparse_values = part("values");
      a.sparse_index_type = component_type_of(*sparse->object("indices", Need::kRequired));
      if (!is_unsigned(a.sparse_index_type))
        o.fail("has sparse indices that are not unsigned integers");
    }
    document_.accessors.push_back(a);
    properties_.accessors.push_back(source);
  }

  static ComponentType component_type_of(const JsonObject& o) {
    const std::size_t number = o.size("componentType", Need::kRequired);
    const auto type = number < 0xffff ? component_type(static_cast<int>(number)) : std::nullopt;
    if (!type) o.fail("has an unknown componentType");
    return *type;
  }

  void read_mesh(const JsonObject& o) {
    Mesh mesh;
    mesh.weights = o.numbers("weights", 0);
    const bool has_weights = !mesh.weights.empty();
    for (const JsonObject& p :
         o.objects("primitives", o.place() + ", primitive", Need::kRequired)) {
      mesh.primitives.push_back(read_primitive(p));
      if (!has_weights) mesh.weights.resize(mesh.primitives[0].target_offsets.size(), 0.0);
    }
    document_.meshes.push_back(std::move(mesh));
  }

  /// Of all attributes, those that are not used, too.
  static void check_indices(const JsonObject& attributes) {
    for (const std::string& name : attributes.keys())
      attributes.index(name.c_str(), "accessors", Need::kRequired);
  }

  Primitive read_primitive(const JsonObject& o) {
    const JsonObject attributes = *o.object("attributes", Need::kRequired);
    check_indices(attributes);
    const auto role = [](const JsonObject& from, const std::string& name) {
      return from.index(name.c_str(), "accessors", Need::kOptional);
    };
    const auto sets = [&](const std::string& name) {
      std::vector<int> all;
      for (int a; (a = role(attributes, name + std::to_string(all.size()))) != kNone;)
        all.push_back(a);
      return all;
    };
    Primitive p;
    const std::size_t mode = o.has("mode") ? o.size("mode", Need::kRequired) : 4;
    if (mode > 6) o.fail("has an unknown mode");
    p.mode = static_cast<PrimitiveMode>(mode);
    p.indices = o.index("indices", "accessors", Need::kOptional);
    p.material = o.index("material", "materials", Need::kOptional);
    p.positions = role(attributes, "POSITION");
    p.normals = role(attributes, "NORMAL");
    p.colors = role(attributes, "COLOR_0");
    p.texcoords = sets("TEXCOORD_");
    p.joints = sets("JOINTS_");
    p.weights = sets("WEIGHTS_");
    if (p.joints.size() != p.weights.size())
      o.fail("has joints without weights or weights without joints");
    for (const JsonObject& target :
         o.objects("targets", o.place() + ", morph target", Need::kOptional)) {
      check_indices(target);
      p.target_offsets.push_back(role(target, "POSITION"));
    }
    compression_.add_primitive(o, attributes);
    return p;
  }

  void read_node(const JsonObject& o) {
    Node node;
    node.name = o.name();
    node.children = o.indices("children", "nodes", Need::kOptional);
    node.mesh = o.index("mesh", "meshes", Need::kOptional);
    node.skin = o.index("skin", "skins", Need::kOptional);
    node.weights = o.numbers("weights", 0);
    if (node.mesh != kNone && node.weights.empty())
      node.weights = entry(document_.meshes, node.mesh).weights;
    const auto vector_or = [&](const char* key, const Vec3d& fallback) {
      const std::vector<double> v = o.numbers(key, 3);
      return v.empty() ? fallback : Vec3d{v[0], v[1], v[2]};
    };
    node.translation = vector_or("translation", node.translation);
    node.scale = vector_or("scale", node.scale);
    const std::vector<double> q = o.numbers("rotation", 4);
    if (!q.empty()) node.rotation = normalized(Quaternion{q[0], q[1], q[2], q[3]});
    const std::vector<double> matrix = o.numbers("matrix", 16);
    if (!matrix.empty()) set_matrix(o, matrix, node);
    document_.nodes.push_back(std::move(node));
  }

  static void set_matrix(const JsonObject& o, const std::vector<double>& columns, Node& node) {
    constexpr double kTolerance = 1e-4;
    const double last_row[4] = {columns[3], columns[7], columns[11], columns[15] - 1};
    for (double number : last_row)
      if (!(std::abs(number) < kTolerance)) o.fail("has a matrix with perspective");
    node.has_matrix = true;
    for (std::size_t row = 0; row < 3; ++row)
      for (std::size_t column = 0; column < 4; ++column)
        node.matrix.m[row][column] = columns[column * 4 + row];
  }

  void read_skin(const JsonObject& o) {
    Skin skin;
    skin.joints = o.indices("joints", "nodes", Need::kRequired);
    if (skin.joints.empty()) o.fail("has no joints");
    skin.inverse_bind_matrices = o.index("inverseBindMatrices", "accessors", Need::kOptional);
    document_.skins.push_back(std::move(skin));
  }

  /// Channels that move nothing known (an extension's, or without a node) are dropped.
  void read_animation(const JsonObject& o) {
    Animation animation{o.string("name", Need::kOptional), {}};
    std::vector<Channel> samplers;
    std::vector<std::optional<Interpolation>> interpolations;
    for (const JsonObject& s : o.objects("samplers", o.place() + ", sampler", Need::kRequired)) {
      samplers.push_back({.input = s.index("input", "accessors", Need::kRequired),
                          .output = s.index("output", "accessors", Need::kRequired)});
      interpolations.push_back(interpolation(s.string_or("interpolation", "LINEAR")));
    }
    for (const JsonObject& c : o.objects("channels", o.place() + ", channel", Need::kRequired)) {
      const std::size_t sampler = c.size("sampler", Need::kRequired);
      if (sampler >= samplers.size()) c.fail("has a sampler that does not exist");
      const JsonObject target = *c.object("target", Need::kRequired);
      const int node = target.index("node", "nodes", Need::kOptional);
      const auto path = track_path(target.string("path", Need::kRequired));
      if (node == kNone || !path) continue;
      if (!interpolations[sampler]) o.fail("has an unknown interpolation");
      Channel channel = samplers[sampler];
      channel.node = node;
      channel.path = *path;
      channel.interpolation = *interpolations[sampler];
      animation.channels.push_back(channel);
    }
    document_.animations.push_back(std::move(animation));
  }

  void read_texture(const JsonObject& o) {
    textures_.push_back({o.index("source", "images", Need::kOptional),
                         o.index("sampler", "samplers", Need::kOptional)});
  }

  void read_sampler(const JsonObject& o) {
    samplers_.push_back(
        {texture_wrap(o.small_size("wrapS", 0)), texture_wrap(o.small_size("wrapT", 0))});
  }

  void read_material(const JsonObject& o) {
    MaterialSource material;
    std::ranges::fill(material.material.base_color, 1.0f);
    if (o.extension("KHR_materials_unlit")) material.material.flags = kMaterialUnlit;
    const auto pbr = o.object("pbrMetallicRoughness", Need::kOptional);
    if (pbr) {
      const std::vector<double> color = pbr->numbers("baseColorFactor", 4);
      for (std::size_t i = 0; i < color.size(); ++i)
        material.material.base_color[i] = static_cast<float>(std::clamp(color[i], 0.0, 1.0));
      if (const auto texture = pbr->object("baseColorTexture", Need::kOptional))
        set_texture(*texture, material);
    }
    document_.materials.push_back(material);
  }

  void set_texture(const JsonObject& o, MaterialSource& material) const {
    const TextureSource& texture = entry(textures_, o.index("index", "textures", Need::kRequired));
    material.image = texture.image;
    material.texcoord_set = o.small_size("texCoord", 0);
    if (texture.sampler != kNone) {
      const Sampler& sampler = entry(samplers_, texture.sampler);
      material.material.wrap_u = sampler.wrap_u;
      material.material.wrap_v = sampler.wrap_v;
    }
    if (const auto transform = o.extension("KHR_texture_transform"))
      set_transform(*transform, material);
  }

  /// Offset after rotation after scale. v points down, so counter-clockwise is (u, v) -> (v, -u).
  static void set_transform(const JsonObject& o, MaterialSource& material) {
    const auto pair_or = [&](const char* key, double fallback) {
      const std::vector<double> p = o.numbers(key, 2);
      return p.empty() ? std::pair(fallback, fallback) : std::pair(p[0], p[1]);
    };
    const auto [offset_u, offset_v] = pair_or("offset", 0);
    const auto [scale_u, scale_v] = pair_or("scale", 1);
    const double angle = o.number_or("rotation", 0);
    const double c = std::cos(angle), s = std::sin(angle);
    material.u_row = {c * scale_u, s * scale_v, offset_u};
    material.v_row = {-s * scale_u, c * scale_v, offset_v};
    material.texcoord_set = o.small_size("texCoord", material.texcoord_set);
  }

  void read_image(const JsonObject& o) {
    if (o.has("bufferView") == o.has("uri")) o.fail("needs either a uri or a bufferView");
    properties_.image_views.push_back(o.index("bufferView", "bufferViews", Need::kOptional));
    document_.images.push_back({{}, o.string("uri", Need::kOptional)});
  }

  void read_scenes() {
    std::vector<std::vector<int>> scenes;
    for (const JsonObject& o : root_.objects("scenes", "scene", Need::kOptional))
      scenes.push_back(o.indices("nodes", "nodes", Need::kOptional));
    const int chosen = root_.index("scene", "scenes", Need::kOptional);
    if (!scenes.empty()) properties_.scene = entry(scenes, std::max(0, chosen));
  }

  const JsonObject root_;
  Document& document_;
  ReadResult& result_;
  Properties properties_;
  CompressionReader compression_{properties_};
  std::vector<TextureSource> textures_;
  std::vector<Sampler> samplers_;
};

}  // namespace

Properties read_properties(std::string_view json, Document& document, ReadResult& result) {
  const Json root = parse_json(document.path, json);
  if (!root.is_object()) throw bad_input(document.path, "the JSON is not an object");
  return PropertiesReader(root, document, result).read();
}

}  // namespace mdk::gltf
