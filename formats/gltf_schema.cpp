// One member function per kind of glTF object, each listing the properties that are used. A place
// ("accessor 3") travels along for the messages.
#include "formats/gltf_schema.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>

#include "common/base/error.h"
#include "formats/gltf_compression_check.h"
#include "formats/gltf_draco.h"
#include "formats/gltf_json_check.h"
#include "formats/gltf_meshopt.h"

namespace mdk::gltf {
namespace {

constexpr int kMaxNesting = 256;
constexpr std::size_t kMostOfName = 60;  // of an extension, in a sentence

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

class SchemaCheck : private JsonCheck {
 public:
  using JsonCheck::JsonCheck;

  SchemaSummary run() {
    if (!root().is_object()) fail("the JSON", "is not an object");
    asset();
    extensions();
    each("buffers", "buffer", &SchemaCheck::buffer);
    each("bufferViews", "buffer view", &SchemaCheck::buffer_view);
    each("accessors", "accessor", &SchemaCheck::accessor);
    each("meshes", "mesh", &SchemaCheck::mesh);
    each("nodes", "node", &SchemaCheck::node);
    each("skins", "skin", &SchemaCheck::skin);
    each("animations", "animation", &SchemaCheck::animation);
    each("materials", "material", &SchemaCheck::material);
    each("textures", "texture", &SchemaCheck::texture);
    each("images", "image", &SchemaCheck::image);
    each("samplers", "sampler", &SchemaCheck::sampler);
    each("scenes", "scene", &SchemaCheck::scene);
    index(root(), "the file", "scene", "scenes", Need::kOptional);
    return std::move(summary_);
  }

 private:
  using Check = void (SchemaCheck::*)(const Json&, const std::string&);

  void each(const char* list, const std::string& what, Check check) {
    const Json* a = array(root(), "the file", list, Need::kOptional);
    if (!a) return;
    for (std::size_t i = 0; i < a->size(); ++i) {
      const std::string at = what + " " + std::to_string(i);
      if (!(*a)[i].is_object()) fail(at, "is not an object");
      (this->*check)((*a)[i], at);
    }
  }

  void asset() const {
    const Json* a = object(root(), "the file", "asset", Need::kRequired);
    string(*a, "the asset", "version", Need::kRequired);
    const std::string version = (*a)["version"].get<std::string>();
    if (!version.starts_with("2."))
      fail("the asset", "is glTF " + version.substr(0, 20) + "; only glTF 2 can be read");
  }

  void extensions() {
    if (const Json* required = array(root(), "the file", "extensionsRequired", Need::kOptional))
      for (const Json& e : *required) {
        if (!e.is_string()) fail("the file", "has an \"extensionsRequired\" that is no string");
        const std::string name = e.get<std::string>();
        if (!is_known(name))
          fail("the file", "needs the extension " + name.substr(0, kMostOfName) +
                               ", which is not supported; " + cure_for(name));
      }
    if (const Json* used = array(root(), "the file", "extensionsUsed", Need::kOptional))
      for (const Json& e : *used)
        if (e.is_string() && !is_known(e.get<std::string>()))
          summary_.ignored_extensions.push_back(e.get<std::string>().substr(0, kMostOfName));
  }

  void buffer(const Json& o, const std::string& at) {
    const std::size_t bytes = size(o, at, "byteLength", Need::kRequired);
    if (bytes == 0) fail(at, "is empty");
    buffer_bytes_.push_back(bytes);
    string(o, at, "uri", Need::kOptional);
    if (!o.contains("uri")) return;
    const std::string& uri = o["uri"].get_ref<const std::string&>();
    if (uri.empty()) fail(at, "has an empty uri");
    if (!uri.starts_with("data:")) {
      summary_.external_buffers.push_back({buffer_bytes_.size() - 1, uri, bytes});
    } else if (!uri.starts_with("data:application/octet-stream;base64,") &&
               !uri.starts_with("data:application/gltf-buffer;base64,")) {
      fail(at, "has a data URI that is not base64 of application/octet-stream");
    }
  }

  void buffer_view(const Json& o, const std::string& at) {
    index(o, at, "buffer", "buffers", Need::kRequired);
    const std::size_t offset = size(o, at, "byteOffset", Need::kOptional);
    const std::size_t bytes = size(o, at, "byteLength", Need::kRequired);
    const std::size_t available = buffer_bytes_[o["buffer"].get<std::size_t>()];
    if (bytes == 0 || offset > available || bytes > available - offset)
      fail(at, "reaches outside its buffer");
    const std::size_t stride = size(o, at, "byteStride", Need::kOptional);
    if (o.contains("byteStride") && (stride < 4 || stride > 252 || stride % 4 != 0))
      fail(at, "has a byteStride that is not a multiple of 4 from 4 to 252");
  }

  void accessor(const Json& o, const std::string& at) {
    index(o, at, "bufferView", "bufferViews", Need::kOptional);
    size(o, at, "byteOffset", Need::kOptional);
    small_size(o, at, "componentType", Need::kRequired);
    boolean(o, at, "normalized");
    string(o, at, "type", Need::kRequired);
    if (size(o, at, "count", Need::kRequired) == 0) fail(at, "has no elements");
    const Json* sparse = object(o, at, "sparse", Need::kOptional);
    if (!sparse) return;
    small_size(*sparse, at, "count", Need::kRequired);
    for (const char* part : {"indices", "values"}) {
      const Json* p = object(*sparse, at, part, Need::kRequired);
      index(*p, at, "bufferView", "bufferViews", Need::kRequired);
      small_size(*p, at, "byteOffset", Need::kOptional);
    }
    small_size((*sparse)["indices"], at, "componentType", Need::kRequired);
  }

  void attributes(const Json& o, const std::string& at) const {
    for (const auto& [name, value] : o.items()) index_value(value, at, name.c_str(), "accessors");
  }

  void mesh(const Json& o, const std::string& at) {
    numbers(o, at, "weights", 0);
    const Json* primitives = array(o, at, "primitives", Need::kRequired);
    for (std::size_t i = 0; i < primitives->size(); ++i) {
      const Json& p = (*primitives)[i];
      const std::string place = at + ", primitive " + std::to_string(i);
      if (!p.is_object()) fail(place, "is not an object");
      attributes(*object(p, place, "attributes", Need::kRequired), place);
      index(p, place, "indices", "accessors", Need::kOptional);
      index(p, place, "material", "materials", Need::kOptional);
      if (size(p, place, "mode", Need::kOptional) > 6) fail(place, "has an unknown mode");
      const Json* targets = array(p, place, "targets", Need::kOptional);
      if (!targets) continue;
      for (const Json& target : *targets) {
        if (!target.is_object()) fail(place, "has a morph target that is not an object");
        attributes(target, place);
      }
    }
  }

  void node(const Json& o, const std::string& at) {
    numbers(o, at, "matrix", 16);
    numbers(o, at, "translation", 3);
    numbers(o, at, "rotation", 4);
    numbers(o, at, "scale", 3);
    numbers(o, at, "weights", 0);
    indices(o, at, "children", "nodes", Need::kOptional);
    index(o, at, "mesh", "meshes", Need::kOptional);
    index(o, at, "skin", "skins", Need::kOptional);
  }

  void skin(const Json& o, const std::string& at) {
    indices(o, at, "joints", "nodes", Need::kRequired);
    if (o["joints"].empty()) fail(at, "has no joints");
    index(o, at, "inverseBindMatrices", "accessors", Need::kOptional);
  }

  void animation(const Json& o, const std::string& at) {
    string(o, at, "name", Need::kOptional);
    const Json* samplers = array(o, at, "samplers", Need::kRequired);
    for (std::size_t i = 0; i < samplers->size(); ++i) {
      const std::string place = at + ", sampler " + std::to_string(i);
      const Json& s = (*samplers)[i];
      if (!s.is_object()) fail(place, "is not an object");
      index(s, place, "input", "accessors", Need::kRequired);
      index(s, place, "output", "accessors", Need::kRequired);
      string(s, place, "interpolation", Need::kOptional);
    }
    const Json* channels = array(o, at, "channels", Need::kRequired);
    for (std::size_t i = 0; i < channels->size(); ++i) {
      const std::string place = at + ", channel " + std::to_string(i);
      const Json& c = (*channels)[i];
      if (!c.is_object()) fail(place, "is not an object");
      if (size(c, place, "sampler", Need::kRequired) >= samplers->size())
        fail(place, "has a sampler that does not exist");
      const Json* target = object(c, place, "target", Need::kRequired);
      index(*target, place, "node", "nodes", Need::kOptional);
      string(*target, place, "path", Need::kRequired);
    }
  }

  void material(const Json& o, const std::string& at) {
    const Json* pbr = object(o, at, "pbrMetallicRoughness", Need::kOptional);
    if (!pbr) return;
    numbers(*pbr, at, "baseColorFactor", 4);
    const Json* info = object(*pbr, at, "baseColorTexture", Need::kOptional);
    if (!info) return;
    index(*info, at, "index", "textures", Need::kRequired);
    small_size(*info, at, "texCoord", Need::kOptional);
    const Json* all = object(*info, at, "extensions", Need::kOptional);
    const Json* transform =
        all ? object(*all, at, "KHR_texture_transform", Need::kOptional) : nullptr;
    if (!transform) return;
    numbers(*transform, at, "offset", 2);
    numbers(*transform, at, "scale", 2);
    number(*transform, at, "rotation");
    small_size(*transform, at, "texCoord", Need::kOptional);
  }

  void texture(const Json& o, const std::string& at) {
    index(o, at, "source", "images", Need::kOptional);
    index(o, at, "sampler", "samplers", Need::kOptional);
  }

  void image(const Json& o, const std::string& at) {
    index(o, at, "bufferView", "bufferViews", Need::kOptional);
    string(o, at, "uri", Need::kOptional);
  }

  void sampler(const Json& o, const std::string& at) {
    small_size(o, at, "wrapS", Need::kOptional);
    small_size(o, at, "wrapT", Need::kOptional);
  }

  void scene(const Json& o, const std::string& at) {
    indices(o, at, "nodes", "nodes", Need::kOptional);
  }

  std::vector<std::size_t> buffer_bytes_;
  SchemaSummary summary_;
};

}  // namespace

void check_nesting(const std::string& file, std::string_view json) {
  int depth = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const char c = json[i];
    if (in_string) {
      if (c == '\\') ++i;
      if (c == '"') in_string = false;
    } else if (c == '"') {
      in_string = true;
    } else if (c == '[' || c == '{') {
      if (++depth > kMaxNesting)
        throw bad_input(file, "the JSON is nested more than " + std::to_string(kMaxNesting) +
                                  " deep at byte " + std::to_string(i));
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
}

SchemaSummary check_schema(const std::string& file, std::string_view json) {
  check_nesting(file, json);
  Json root;
  try {
    root = Json::parse(json.begin(), json.end());
  } catch (const Json::parse_error& e) {
    throw bad_input(file, "the JSON is broken at byte " + std::to_string(e.byte));
  } catch (const Json::exception&) {
    throw bad_input(file, "the JSON holds a number that is out of range");
  }
  SchemaSummary summary = SchemaCheck(file, root).run();
  summary.compression = check_compression(file, root);
  if (!summary.compression.is_used()) return summary;
  hide_compression(summary.compression, root);
  summary.plain_json = root.dump();
  // What has no data is not looked for, either.
  std::erase_if(summary.external_buffers, [&](const ExternalBuffer& buffer) {
    return std::ranges::count(summary.compression.empty_buffers, buffer.number) > 0;
  });
  return summary;
}

}  // namespace mdk::gltf
