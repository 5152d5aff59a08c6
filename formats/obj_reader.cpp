// One pass over the lines.
#include "formats/obj_reader.h"

#include <cmath>
#include <cstddef>
#include <optional>
#include <string_view>

#include "common/base/error.h"
#include "formats/mapped_file.h"
#include "formats/text_scan.h"

namespace mdk {
namespace {

constexpr std::uint32_t kWhite = 0xffffffffu;

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

/// The words of one statement: blanks part them, and so does a backslash at the end of a line.
class Words {
 public:
  explicit Words(std::string_view statement) : rest_(statement) {}

  /// Empty at the end.
  std::string_view next() {
    while (!rest_.empty() && is_gap(rest_.front())) rest_.remove_prefix(1);
    std::size_t size = 0;
    while (size < rest_.size() && !is_gap(rest_[size])) ++size;
    const std::string_view word = rest_.substr(0, size);
    rest_.remove_prefix(size);
    return word;
  }

 private:
  static bool is_gap(char c) { return is_blank(c) || c == '\n' || c == '\\'; }

  std::string_view rest_;
};

/// Cuts the text into statements and counts the lines they start on.
class Statements {
 public:
  explicit Statements(std::string_view text) : rest_(text) {}

  bool next(std::string_view& statement) {
    if (rest_.empty()) return false;
    line_ = next_line_;
    std::size_t end = 0;
    while (end < rest_.size()) {
      if (rest_[end] == '\n') {
        ++next_line_;
        if (!continues(end)) break;
      }
      ++end;
    }
    statement = rest_.substr(0, end);
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    return true;
  }
  std::size_t line() const { return line_; }

 private:
  bool continues(std::size_t end) const {
    while (end > 0 && rest_[end - 1] == '\r') --end;
    return end > 0 && rest_[end - 1] == '\\';
  }

  std::string_view rest_;
  std::size_t line_ = 0, next_line_ = 1;
};

class ObjParser {
 public:
  explicit ObjParser(const std::string& path) : path_(path) {}

  TriangleMesh parse(std::string_view text) {
    Statements statements(text);
    for (std::string_view statement; statements.next(statement);) {
      line_ = statements.line();
      Words words(statement);
      const std::string_view keyword = words.next();
      if (keyword == "v") {
        add_vertex(words);
      } else if (keyword == "f") {
        add_face(words);
      } else if (keyword == "usemtl") {
        has_materials_ = true;
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
  void add_vertex(Words& words) {
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

  void add_face(Words& words) {
    std::uint32_t first = 0, last = 0;
    std::size_t corners = 0;
    for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
      const std::uint32_t corner = vertex_of(word);
      if (corners == 0) first = corner;
      if (corners >= 2) {
        if (mesh_.triangles.size() == kMaxMeshTriangles)
          throw Error(ErrorCode::kOverLimit, path_ + ": has over 178 million triangles");
        mesh_.triangles.push_back({{first, last, corner}});
      }
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

  [[noreturn]] void no_such(std::size_t line, std::string_view word) const {
    fail(line, "a face has the corner " + quoted(word) + ", which the file has no vertex for");
  }

  void finish() {
    if (mesh_.triangles.empty()) throw bad_input(path_, "has no faces");
    if (largest_ >= mesh_.vertices.size())
      no_such(largest_line_, std::to_string(std::uint64_t{largest_} + 1));
    if (!mesh_.vertex_colors.empty()) mesh_.vertex_colors.resize(mesh_.vertices.size(), kWhite);
    if (has_materials_) mesh_.notes.push_back("the materials of " + path_ + " are not read");
  }

  const std::string& path_;
  std::size_t line_ = 0;
  std::uint32_t largest_ = 0;     ///< of all vertices that faces use
  std::size_t largest_line_ = 0;  ///< where; 0 before the first face
  bool has_materials_ = false;
  TriangleMesh mesh_;
};

}  // namespace

TriangleMesh read_obj(const std::string& path) {
  const MappedFile file(path);
  const std::span<const std::byte> bytes = file.bytes();
  return parse_obj(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

TriangleMesh parse_obj(const std::string& path, std::string_view text) {
  return ObjParser(path).parse(text);
}

}  // namespace mdk
