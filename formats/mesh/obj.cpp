// Wavefront .obj: one pass over the lines.

#include <cmath>
#include <cstddef>
#include <optional>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "common/base/error.h"
#include "formats/files/text.h"
#include "formats/mesh/triangle_mesh.h"
#include "formats/mesh/words.h"

namespace mdk {
namespace {

constexpr std::uint32_t kWhite = 0xffffffffu;

constexpr std::uint32_t kNoIndex = 0xffffffffu;

struct Corner {
  std::uint32_t vertex = 0;
  std::uint32_t texcoord = kNoIndex;
};

class ObjParser {
 public:
  ObjParser(const std::string& path, ObjContent content)
      : path_(path), with_materials_(content == ObjContent::kShapeAndMaterials) {}

  TriangleMesh parse(std::string_view text) {
    Statements statements(text);
    for (std::string_view statement; statements.next(statement);) {
      line_ = statements.line();
      StatementWords words(statement);
      const std::string_view keyword = words.next();
      if (keyword == "v") {
        add_vertex(words);
      } else if (keyword == "f") {
        add_face(words);
      } else if (with_materials_) {
        add_to_materials(keyword, words);
      }
    }
    finish();
    return std::move(mesh_);
  }

 private:
  [[noreturn]] void fail(std::size_t line, const std::string& sentence) const {
    throw bad_input(path_, "line " + std::to_string(line) + ": " + sentence);
  }

  /// x y z, then nothing, a weight, or a colour (and what some programs append to it).
  void add_vertex(StatementWords& words) {
    float numbers[6] = {};
    std::size_t count = 0;
    for (std::string_view word = words.next(); !word.empty() && count < 6; word = words.next()) {
      const std::optional<float> number = parsed<float>(word);
      if (!number || !std::isfinite(*number)) fail(line_, quoted(word) + " is not a finite number");
      numbers[count++] = *number;
    }
    if (count < 3) fail(line_, "a vertex needs three coordinates");
    if (mesh_.vertices.size() == kMaxMeshVertices)
      throw Error(ErrorCode::kOverLimit, path_ + ": has over 134 million vertices");
    mesh_.vertices.push_back({numbers[0], numbers[1], numbers[2]});
    if (count == 6) {
      mesh_.vertex_colors.resize(mesh_.vertices.size() - 1, kWhite);
      mesh_.vertex_colors.push_back(linear_color({numbers[3], numbers[4], numbers[5]}));
    }
  }

  void add_to_materials(std::string_view keyword, StatementWords& words) {
    if (keyword == "vt") {
      const auto coordinate = [&] {
        const std::optional<float> number = parsed<float>(words.next());
        return number && std::isfinite(*number) ? *number : 0;
      };
      const float u = coordinate(), v = coordinate();
      texcoords_.push_back({u, 1 - v});
    } else if (keyword == "usemtl") {
      use_material(words.rest());
    } else if (keyword == "mtllib") {
      mesh_.materials.libraries.emplace_back(words.rest());
    }
  }

  void use_material(std::string_view name) {
    const auto next = static_cast<std::uint32_t>(mesh_.materials.names.size());
    const auto [known, is_new] = material_numbers_.try_emplace(std::string(name), next);
    if (is_new) mesh_.materials.names.emplace_back(name);
    material_ = known->second;
  }

  void add_triangle(const Corner& a, const Corner& b, const Corner& c) {
    if (mesh_.triangles.size() == kMaxMeshTriangles)
      throw Error(ErrorCode::kOverLimit, path_ + ": has over 178 million triangles");
    mesh_.triangles.push_back({{a.vertex, b.vertex, c.vertex}});
    if (!with_materials_) return;
    if (material_ == kNoIndex) use_material("");
    mesh_.materials.triangles.push_back(material_);
    for (const Corner& corner : {a, b, c}) corner_texcoords_.push_back(corner.texcoord);
  }

  void add_face(StatementWords& words) {
    Corner first, last;
    std::size_t corners = 0;
    for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
      const Corner corner{vertex_of(word), with_materials_ ? texcoord_of(word) : kNoIndex};
      if (corners == 0) first = corner;
      if (corners >= 2) add_triangle(first, last, corner);
      last = corner;
      ++corners;
    }
    if (corners < 3) fail(line_, "a face needs three corners");
  }

  /// "7", "7/1", "7//2" or "7/1/2": the first number is the vertex, from 1, or from the last one
  /// backwards where it is negative. Vertices may come after the faces that use them.
  std::uint32_t vertex_of(std::string_view word) {
    const std::string_view digits = word.substr(0, word.find('/'));
    const std::optional<std::int64_t> number = parsed<std::int64_t>(digits);
    if (!number || *number == 0) fail(line_, quoted(word) + " is not the number of a vertex");
    const auto count = static_cast<std::int64_t>(mesh_.vertices.size());
    if (*number < -count || *number > static_cast<std::int64_t>(kMaxMeshVertices))
      no_such(line_, word);
    const auto vertex = static_cast<std::uint32_t>(*number < 0 ? count + *number : *number - 1);
    if (largest_line_ == 0 || vertex > largest_) {
      largest_ = vertex;
      largest_line_ = line_;
    }
    return vertex;
  }

  /// The second number of a corner, counted like the first; kNoIndex where there is none.
  std::uint32_t texcoord_of(std::string_view word) const {
    const std::size_t slash = word.find('/');
    if (slash == word.npos) return kNoIndex;
    word.remove_prefix(slash + 1);
    const std::optional<std::int64_t> number = parsed<std::int64_t>(word.substr(0, word.find('/')));
    const auto count = static_cast<std::int64_t>(texcoords_.size());
    if (!number || *number == 0 || *number < -count || *number > std::int64_t{kNoIndex})
      return kNoIndex;
    return static_cast<std::uint32_t>(*number < 0 ? count + *number : *number - 1);
  }

  [[noreturn]] void no_such(std::size_t line, std::string_view word) const {
    fail(line, "a face has the corner " + quoted(word) + ", which the file has no vertex for");
  }

  void finish() {
    if (mesh_.triangles.empty()) throw bad_input(path_, "has no faces");
    if (largest_ >= mesh_.vertices.size())
      no_such(largest_line_, std::to_string(std::uint64_t{largest_} + 1));
    if (!mesh_.vertex_colors.empty()) mesh_.vertex_colors.resize(mesh_.vertices.size(), kWhite);
    if (!texcoords_.empty()) look_up_texcoords();
  }

  /// They may come after the faces that use them.
  void look_up_texcoords() {
    mesh_.materials.corners.reserve(corner_texcoords_.size());
    for (const std::uint32_t t : corner_texcoords_) {
      const bool is_there = t < texcoords_.size();
      mesh_.materials.is_missing_texcoords |= !is_there;
      mesh_.materials.corners.push_back(is_there ? texcoords_[t] : TexCoord{});
    }
  }

  const std::string& path_;
  std::size_t line_ = 0;
  std::uint32_t largest_ = 0;     ///< of all vertices that faces use
  std::size_t largest_line_ = 0;  ///< where; 0 before the first face
  const bool with_materials_;
  std::uint32_t material_ = kNoIndex;
  std::unordered_map<std::string, std::uint32_t> material_numbers_;
  std::vector<TexCoord> texcoords_;
  std::vector<std::uint32_t> corner_texcoords_;
  TriangleMesh mesh_;
};

}  // namespace

TriangleMesh parse_obj(const std::string& path, std::string_view text, ObjContent content) {
  return ObjParser(path, content).parse(text);
}

}  // namespace mdk
