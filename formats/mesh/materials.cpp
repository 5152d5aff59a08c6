#include "formats/mesh/materials.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <unordered_map>
#include <utility>

#include "common/base/error.h"
#include "formats/files/file_kind.h"
#include "formats/files/mapped_file.h"
#include "formats/files/notes.h"
#include "formats/files/text.h"
#include "formats/gltf/files.h"
#include "formats/gltf/images.h"
#include "formats/mesh/words.h"

namespace mdk {
namespace {

constexpr std::size_t kMaxMtlBytes = std::size_t{64} << 20;
constexpr std::size_t kMaxNotes = 100;  // nobody reads more

/// Names are written on all systems.
std::string with_slashes(std::string_view name) {
  std::string text(name);
  std::ranges::replace(text, '\\', '/');
  return text;
}

void set_white(Material& material) { std::ranges::fill(material.base_color, 1.0f); }

class MtlParser {
 public:
  MtlParser(const std::string& path, std::vector<std::string>& notes)
      : path_(path), notes_(notes) {}

  std::vector<MtlMaterial> parse(std::string_view text) {
    Statements statements(text);
    for (std::string_view statement; statements.next(statement);) {
      StatementWords words(statement);
      const std::string_view keyword = words.next();
      if (keyword == "newmtl") {
        materials_.push_back({std::string(words.rest()), {}, {}});
      } else if (materials_.empty()) {
        continue;
      } else if (keyword == "Kd") {
        read_color(words, statements.line());
      } else if (keyword == "map_Kd") {
        read_texture(words);
      }
    }
    return std::move(materials_);
  }

 private:
  /// Red, green and blue, or one number for all three.
  void read_color(StatementWords words, std::size_t line) {
    std::optional<double> channels[3];
    for (std::size_t c = 0; c < 3; ++c) {
      const std::string_view word = words.next();
      channels[c] = c > 0 && word.empty() ? channels[0] : parsed<double>(word);
      if (channels[c] && std::isfinite(*channels[c])) continue;
      if (!std::exchange(has_noted_color_, true))
        notes_.push_back(path_ + ": line " + std::to_string(line) +
                         " has a colour that cannot be read; grey is shown");
      return;
    }
    for (std::size_t c = 0; c < 3; ++c)
      materials_.back().material.base_color[c] = static_cast<float>(linear_channel(*channels[c]));
  }

  /// "-o 0.5 0 0 -clamp on wood.png": options are a word with a dash, then numbers or on and off.
  void read_texture(StatementWords words) {
    bool has_options = false;
    while (words.rest().starts_with('-')) {
      has_options = true;
      words.next();
      for (StatementWords next = words; is_option_value(next.next()); next = words) words.next();
    }
    materials_.back().map_kd = words.rest();
    if (has_options && !std::exchange(has_noted_options_, true))
      notes_.push_back(path_ + ": the options of a map_Kd are left out; its image is shown");
  }

  static bool is_option_value(std::string_view word) {
    return word == "on" || word == "off" || parsed<double>(word).has_value();
  }

  const std::string& path_;
  std::vector<std::string>& notes_;
  bool has_noted_color_ = false, has_noted_options_ = false;  ///< one note a file, however broken
  std::vector<MtlMaterial> materials_;
};

class AppearanceReader {
 public:
  AppearanceReader(const std::string& obj_path, const TriangleMesh& mesh, ReadResult& result)
      : obj_path_(obj_path), mesh_(mesh), result_(result) {}

  Appearance read() {
    for (const std::string& name : mesh_.materials.libraries) read_library(with_slashes(name));
    for (const std::string& name : mesh_.materials.names) add_material(name);
    if (appearance_.materials.empty()) appearance_.materials.push_back(plain());
    appearance_.triangle_materials = mesh_.materials.triangles;
    appearance_.triangle_materials.resize(mesh_.triangles.size(), 0);
    if (!appearance_.textures.empty()) {
      appearance_.corner_texcoords = mesh_.materials.corners;
      if (mesh_.materials.is_missing_texcoords)
        note("some corners of " + obj_path_ + " have no texture coordinates; (0, 0) is taken");
    }
    if (!mesh_.vertex_colors.empty())
      for (const Triangle& triangle : mesh_.triangles)
        for (const std::uint32_t v : triangle.v)
          appearance_.corner_colors.push_back(mesh_.vertex_colors[v]);
    return std::move(appearance_);
  }

 private:
  struct Described {
    MtlMaterial material;
    std::string library;  ///< path
  };

  void note(const std::string& sentence) {
    if (result_.notes.size() < kMaxNotes) add_note(result_.notes, sentence);
  }

  /// Where faces name no material: what vertex colours are multiplied with.
  Material plain() const {
    Material material;
    if (!mesh_.vertex_colors.empty()) set_white(material);
    return material;
  }

  /// One name that may have blanks, or else several. Each is read once.
  void read_library(const std::string& names) {
    if (read_file(names)) return;
    StatementWords words(names);
    std::string_view word = words.next();
    if (word.size() == names.size()) return missing(names);
    for (; !word.empty(); word = words.next())
      if (!read_file(std::string(word))) missing(std::string(word));
  }

  bool read_file(const std::string& name) {
    const std::optional<std::string> path = neighbor_path(obj_path_, name);
    if (!path) return false;
    if (std::ranges::find(result_.dependencies, *path) != result_.dependencies.end()) return true;
    try {
      const MappedFile file(*path);
      const std::span<const std::byte> bytes = file.bytes();
      if (bytes.size() > kMaxMtlBytes) return false;
      const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
      for (MtlMaterial& material : parse_mtl(*path, text, result_.notes))
        described_.try_emplace(material.name, Described{material, *path});
    } catch (const Error&) {
      return false;
    }
    result_.dependencies.push_back(*path);
    return true;
  }

  void missing(const std::string& name) {
    const std::optional<std::string> path = neighbor_path(obj_path_, name);
    if (path) result_.unread.push_back(*path);
    is_library_missing_ = true;
    note("the material file \"" + name.substr(0, 200) + "\" of " + obj_path_ +
         " cannot be read beside it; its materials are shown grey");
  }

  void add_material(const std::string& name) {
    Material material = plain();
    if (const auto known = described_.find(name); known != described_.end()) {
      const MtlMaterial& described = known->second.material;
      material = described.material;
      if (!described.map_kd.empty())
        material.texture = texture_of(known->second.library, described.map_kd);
      if (material.texture != kNoTexture) set_white(material);
    } else if (!name.empty() && !is_library_missing_) {
      note(obj_path_ + " uses the material \"" + name.substr(0, 200) +
           "\", which no .mtl describes; it is shown grey");
    }
    appearance_.materials.push_back(material);
  }

  std::uint32_t texture_of(const std::string& library, const std::string& name) {
    if (mesh_.materials.corners.empty()) {
      note(obj_path_ + " has a texture but not its coordinates; its plain colour is shown");
      return kNoTexture;
    }
    const std::optional<std::string> path = neighbor_path(library, with_slashes(name));
    const auto [known, is_new] = textures_.try_emplace(path.value_or(std::string()), kNoTexture);
    std::string problem = path ? "" : "is not in the folder of its .mtl";
    if (path && is_new) known->second = read_texture(*path, problem);
    if (!problem.empty())
      note("the image \"" + name.substr(0, 200) + "\" " + problem +
           "; the plain base colour is shown");
    return known->second;
  }

  std::uint32_t read_texture(const std::string& path, std::string& problem) {
    gltf::Bytes bytes;
    try {
      bytes = gltf::read_whole_file(path);
    } catch (const Error&) {
      result_.unread.push_back(path);
      problem = "cannot be read";
      return kNoTexture;
    }
    result_.dependencies.push_back(path);
    return gltf::add_texture(bytes, appearance_, problem);
  }

  const std::string& obj_path_;
  const TriangleMesh& mesh_;
  ReadResult& result_;
  bool is_library_missing_ = false;
  std::unordered_map<std::string, Described> described_;
  std::map<std::string, std::uint32_t> textures_;  ///< by path
  Appearance appearance_;
};

}  // namespace

std::vector<MtlMaterial> parse_mtl(const std::string& path, std::string_view text,
                                   std::vector<std::string>& notes) {
  return MtlParser(path, notes).parse(text);
}

Appearance read_appearance(const std::string& obj_path, const TriangleMesh& mesh,
                           ReadResult& result) {
  return AppearanceReader(obj_path, mesh, result).read();
}

}  // namespace mdk
