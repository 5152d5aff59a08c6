// One member function per kind of glTF object, each checking the properties that are used.
#include "formats/gltf/schema.h"

#include <algorithm>
#include <array>
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

class SchemaCheck {
 public:
  SchemaCheck(const std::string& file, const Json& json, std::vector<std::string>& notes)
      : root_(file, json, "the file", json), notes_(notes) {}

  Schema run() {
    check_asset();
    check_extensions();
    each("buffers", "buffer", &SchemaCheck::check_buffer);
    each("bufferViews", "buffer view", &SchemaCheck::check_view);
    each("accessors", "accessor", &SchemaCheck::check_accessor);
    each("meshes", "mesh", &SchemaCheck::check_mesh);
    each("nodes", "node", &SchemaCheck::check_node);
    each("skins", "skin", &SchemaCheck::check_skin);
    each("animations", "animation", &SchemaCheck::check_animation);
    each("materials", "material", &SchemaCheck::check_material);
    each("textures", "texture", &SchemaCheck::check_texture);
    each("images", "image", &SchemaCheck::check_image);
    each("samplers", "sampler", &SchemaCheck::check_sampler);
    each("scenes", "scene", &SchemaCheck::check_scene);
    root_.index("scene", "scenes", Need::kOptional);
    return std::move(schema_);
  }

 private:
  void each(const char* list, const std::string& what,
            void (SchemaCheck::*check)(const JsonObject&)) {
    for (const JsonObject& o : root_.objects(list, what, Need::kOptional)) (this->*check)(o);
  }

  void check_asset() const {
    const JsonObject asset = root_.object("asset", Need::kRequired)->at("the asset");
    const std::string version = asset.string("version", Need::kRequired);
    if (!version.starts_with("2."))
      asset.fail("is glTF " + version.substr(0, 20) + "; only glTF 2 can be read");
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
        add_note(notes_, "the extension " + name->substr(0, kMaxExtensionName) + " is left out");
  }

  void check_buffer(const JsonObject& o) {
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
    schema_.buffers.push_back(std::move(buffer));
  }

  void check_view(const JsonObject& o) {
    ByteRange range;
    range.buffer = static_cast<std::size_t>(o.index("buffer", "buffers", Need::kRequired));
    range.offset = o.size("byteOffset", Need::kOptional);
    range.size = o.size("byteLength", Need::kRequired);
    const std::size_t available = schema_.buffers[range.buffer].bytes;
    if (range.size == 0 || range.offset > available || range.size > available - range.offset)
      o.fail("reaches outside its buffer");
    const std::size_t stride = o.size("byteStride", Need::kOptional);
    if (o.has("byteStride") && (stride < 4 || stride > 252 || stride % 4 != 0))
      o.fail("has a byteStride that is not a multiple of 4 from 4 to 252");
    schema_.views.push_back(range);
    compression_.add_view(o);
  }

  void check_accessor(const JsonObject& o) {
    schema_.accessor_views.push_back(o.index("bufferView", "bufferViews", Need::kOptional));
    o.size("byteOffset", Need::kOptional);
    o.small_size("componentType", Need::kRequired);
    o.boolean("normalized");
    o.string("type", Need::kRequired);
    if (o.size("count", Need::kRequired) == 0) o.fail("has no elements");
    const auto sparse = o.object("sparse", Need::kOptional);
    if (!sparse) return;
    sparse->small_size("count", Need::kRequired);
    for (const char* key : {"indices", "values"}) {
      const JsonObject part = *sparse->object(key, Need::kRequired);
      part.index("bufferView", "bufferViews", Need::kRequired);
      part.small_size("byteOffset", Need::kOptional);
    }
    sparse->object("indices", Need::kRequired)->small_size("componentType", Need::kRequired);
  }

  static void check_attributes(const JsonObject& o) {
    for (const std::string& name : o.keys()) o.index(name.c_str(), "accessors", Need::kRequired);
  }

  void check_mesh(const JsonObject& o) {
    o.numbers("weights", 0);
    std::size_t number = 0;
    for (const JsonObject& p : o.objects("primitives", o.place() + ", primitive", Need::kRequired))
      check_primitive(p, number++);
    ++mesh_count_;
  }

  void check_primitive(const JsonObject& o, std::size_t number) {
    const JsonObject attributes = *o.object("attributes", Need::kRequired);
    check_attributes(attributes);
    o.index("indices", "accessors", Need::kOptional);
    o.index("material", "materials", Need::kOptional);
    if (o.size("mode", Need::kOptional) > 6) o.fail("has an unknown mode");
    for (const JsonObject& target :
         o.objects("targets", o.place() + ", morph target", Need::kOptional))
      check_attributes(target);
    compression_.add_primitive(o, attributes, mesh_count_, number);
  }

  void check_node(const JsonObject& o) {
    o.numbers("matrix", 16);
    o.numbers("translation", 3);
    o.numbers("rotation", 4);
    o.numbers("scale", 3);
    o.numbers("weights", 0);
    o.indices("children", "nodes", Need::kOptional);
    o.index("mesh", "meshes", Need::kOptional);
    o.index("skin", "skins", Need::kOptional);
  }

  void check_skin(const JsonObject& o) {
    if (o.indices("joints", "nodes", Need::kRequired) == 0) o.fail("has no joints");
    o.index("inverseBindMatrices", "accessors", Need::kOptional);
  }

  void check_animation(const JsonObject& o) {
    o.string("name", Need::kOptional);
    const auto samplers = o.objects("samplers", o.place() + ", sampler", Need::kRequired);
    for (const JsonObject& s : samplers) {
      s.index("input", "accessors", Need::kRequired);
      s.index("output", "accessors", Need::kRequired);
      s.string("interpolation", Need::kOptional);
    }
    for (const JsonObject& c : o.objects("channels", o.place() + ", channel", Need::kRequired)) {
      if (c.size("sampler", Need::kRequired) >= samplers.size())
        c.fail("has a sampler that does not exist");
      const JsonObject target = *c.object("target", Need::kRequired);
      target.index("node", "nodes", Need::kOptional);
      target.string("path", Need::kRequired);
    }
  }

  void check_material(const JsonObject& o) {
    o.extension("KHR_materials_unlit");
    const auto pbr = o.object("pbrMetallicRoughness", Need::kOptional);
    if (!pbr) return;
    pbr->numbers("baseColorFactor", 4);
    const auto texture = pbr->object("baseColorTexture", Need::kOptional);
    if (!texture) return;
    texture->index("index", "textures", Need::kRequired);
    texture->small_size("texCoord", Need::kOptional);
    const auto transform = texture->extension("KHR_texture_transform");
    if (!transform) return;
    transform->numbers("offset", 2);
    transform->numbers("scale", 2);
    transform->number("rotation");
    transform->small_size("texCoord", Need::kOptional);
  }

  void check_texture(const JsonObject& o) {
    o.index("source", "images", Need::kOptional);
    o.index("sampler", "samplers", Need::kOptional);
  }

  void check_image(const JsonObject& o) {
    o.index("bufferView", "bufferViews", Need::kOptional);
    o.string("uri", Need::kOptional);
  }

  void check_sampler(const JsonObject& o) {
    o.small_size("wrapS", Need::kOptional);
    o.small_size("wrapT", Need::kOptional);
  }

  void check_scene(const JsonObject& o) { o.indices("nodes", "nodes", Need::kOptional); }

  const JsonObject root_;
  std::vector<std::string>& notes_;
  std::size_t mesh_count_ = 0;  ///< checked so far
  Schema schema_;
  CompressionCheck compression_{schema_};
};

/// The file for a reader that knows no compression: buffers without data become one byte, and
/// compressed primitives lose their index lists, whose accessors lead nowhere.
void hide_compression(const Schema& schema, Json& root) {
  for (std::size_t b = 0; b < schema.buffers.size(); ++b)
    if (schema.buffers[b].is_empty)
      root["buffers"][b] = {{"byteLength", 1},
                            {"uri", "data:application/octet-stream;base64,AA=="}};
  for (const DracoPrimitive& p : schema.draco_primitives)
    root["meshes"][p.mesh]["primitives"][p.primitive].erase("indices");
}

}  // namespace

Schema check_schema(const std::string& file, std::string_view json,
                    std::vector<std::string>& notes) {
  Json root = parse_json(file, json);
  if (!root.is_object()) throw bad_input(file, "the JSON is not an object");
  Schema schema = SchemaCheck(file, root, notes).run();
  const bool has_empty_buffer = std::ranges::any_of(schema.buffers, &BufferSource::is_empty);
  if (has_empty_buffer || !schema.draco_primitives.empty()) {
    hide_compression(schema, root);
    schema.plain_json = root.dump();
  }
  return schema;
}

}  // namespace mdk::gltf
