// .ply: a header, which is a text that lists what the body holds, element after element:
//   "ply" | "format ascii|binary_… 1.0" | ("element NAME COUNT" | "property TYPE NAME" |
//   "property list COUNT_TYPE TYPE NAME" | "comment …" | "obj_info …")* | "end_header"
// The body is one row of numbers, words or bytes alike. Two inputs give the next number, and one
// reader, for either, knows what the header says each number is.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

#include "common/base/error.h"
#include "formats/files/byte_order.h"
#include "formats/files/text.h"
#include "formats/mesh/triangle_mesh.h"
#include "formats/mesh/words.h"

namespace mdk {
namespace {

enum class Encoding { kText, kLittleEndian, kBigEndian };

enum class Scalar { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };

struct Property {
  std::string name;
  Scalar type = Scalar::kFloat32;
  bool is_list = false;  ///< a count, then as many numbers
  Scalar count_type = Scalar::kUint8;
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

struct Header {
  Encoding encoding = Encoding::kText;
  std::vector<Element> elements;  ///< in the order of the body
  std::size_t body = 0;           ///< where it starts
};

struct ScalarName {
  std::string_view name;
  Scalar type;
};

constexpr std::array<ScalarName, 16> kScalarNames = {{{"char", Scalar::kInt8},
                                                      {"uchar", Scalar::kUint8},
                                                      {"short", Scalar::kInt16},
                                                      {"ushort", Scalar::kUint16},
                                                      {"int", Scalar::kInt32},
                                                      {"uint", Scalar::kUint32},
                                                      {"float", Scalar::kFloat32},
                                                      {"double", Scalar::kFloat64},
                                                      {"int8", Scalar::kInt8},
                                                      {"uint8", Scalar::kUint8},
                                                      {"int16", Scalar::kInt16},
                                                      {"uint16", Scalar::kUint16},
                                                      {"int32", Scalar::kInt32},
                                                      {"uint32", Scalar::kUint32},
                                                      {"float32", Scalar::kFloat32},
                                                      {"float64", Scalar::kFloat64}}};

class HeaderParser {
 public:
  HeaderParser(const std::string& path, std::string_view file) : path_(path), file_(file) {}

  Header parse() {
    if (!next_line() || words_.next() != "ply")
      throw bad_input(path_, "is not a PLY file: its first line is not \"ply\"");
    bool has_format = false;
    while (next_line()) {
      const std::string_view keyword = words_.next();
      if (keyword == "end_header") {
        if (!has_format) throw bad_input(path_, "has no format line");
        header_.body = at_;
        return std::move(header_);
      }
      if (keyword == "format") {
        read_format();
        has_format = true;
      } else if (keyword == "element") {
        read_element();
      } else if (keyword == "property") {
        read_property();
      } else if (!keyword.empty() && keyword != "comment" && keyword != "obj_info") {
        fail(quoted(keyword) + " is no keyword of a PLY header");
      }
    }
    throw bad_input(path_, "ends within its header");
  }

 private:
  [[noreturn]] void fail(const std::string& sentence) const {
    throw bad_input(path_, "line " + std::to_string(line_) + ": " + sentence);
  }

  /// False where no whole line is left.
  bool next_line() {
    const std::size_t end = file_.find('\n', at_);
    if (end == std::string_view::npos) return false;
    words_ = Words<is_blank>(file_.substr(at_, end - at_));
    at_ = end + 1;
    ++line_;
    return true;
  }

  Scalar next_type() {
    const std::string_view word = words_.next();
    for (const ScalarName& known : kScalarNames)
      if (known.name == word) return known.type;
    fail(quoted(word) + " is no type of a PLY property");
  }

  void read_format() {
    const std::string_view name = words_.next(), version = words_.next();
    if (name == "ascii") {
      header_.encoding = Encoding::kText;
    } else if (name == "binary_little_endian") {
      header_.encoding = Encoding::kLittleEndian;
    } else if (name == "binary_big_endian") {
      header_.encoding = Encoding::kBigEndian;
    } else {
      fail(quoted(name) + " is no PLY format");
    }
    if (version != "1.0") fail("version " + quoted(version) + " of PLY cannot be read, only 1.0");
  }

  void read_element() {
    const std::string_view name = words_.next(), count = words_.next();
    const std::optional<std::uint64_t> number = parsed<std::uint64_t>(count);
    if (name.empty() || !number) fail("an element needs a name and a count");
    header_.elements.push_back({std::string(name), *number, {}});
  }

  void read_property() {
    if (header_.elements.empty()) fail("a property comes before the first element");
    Property property;
    const Words<is_blank> before = words_;
    property.is_list = words_.next() == "list";
    if (property.is_list) {
      property.count_type = next_type();
      if (property.count_type == Scalar::kFloat32 || property.count_type == Scalar::kFloat64)
        fail("a list cannot count in real numbers");
    } else {
      words_ = before;
    }
    property.type = next_type();
    property.name = words_.next();
    if (property.name.empty()) fail("a property needs a name");
    header_.elements.back().properties.push_back(std::move(property));
  }

  const std::string& path_;
  std::string_view file_;
  Words<is_blank> words_{std::string_view()};  ///< of the line
  std::size_t at_ = 0;                         ///< start of the next line
  std::size_t line_ = 0;
  Header header_;
};

std::size_t scalar_bytes(Scalar type) {
  switch (type) {
    case Scalar::kInt8:
    case Scalar::kUint8:
      return 1;
    case Scalar::kInt16:
    case Scalar::kUint16:
      return 2;
    case Scalar::kFloat64:
      return 8;
    default:
      return 4;
  }
}

/// Why a body cannot be read on; the reader knows where.
struct BodyFault {
  std::string sentence;
};

/// Numbers as words, blanks and line breaks between them.
class TextBody {
 public:
  explicit TextBody(std::string_view rest) : words_(rest) {}

  /// What one number takes at least, with the blank after it.
  static constexpr std::size_t bytes_of(Scalar) { return 2; }
  std::size_t bytes_left() const { return words_.bytes_left() + 1; }  // the last blank may miss

  double real(Scalar type) {
    const std::string_view word = next();
    const std::optional<double> value =
        type == Scalar::kFloat64 ? parsed<double>(word) : widened(parsed<float>(word));
    if (!value) throw BodyFault{quoted(word) + " is not a number"};
    return *value;
  }

  std::int64_t whole(Scalar) {
    const std::string_view word = next();
    const std::optional<std::int64_t> value = parsed<std::int64_t>(word);
    if (!value) throw BodyFault{quoted(word) + " is not a whole number"};
    return *value;
  }

  void skip(Scalar) { next(); }

 private:
  static std::optional<double> widened(std::optional<float> value) {
    if (!value) return std::nullopt;
    return static_cast<double>(*value);
  }

  std::string_view next() {
    const std::string_view word = words_.next();
    if (word.empty()) throw BodyFault{"the file is cut short"};
    return word;
  }

  Words<is_blank> words_;
};

/// Numbers as bytes, one after the other.
class BinaryBody {
 public:
  BinaryBody(std::string_view rest, std::endian order) : rest_(rest), order_(order) {}

  static std::size_t bytes_of(Scalar type) { return scalar_bytes(type); }
  std::size_t bytes_left() const { return rest_.size(); }

  double real(Scalar type) {
    if (type == Scalar::kFloat64) return next<double>();
    if (type == Scalar::kFloat32) return static_cast<double>(next<float>());
    return static_cast<double>(whole(type));
  }

  std::int64_t whole(Scalar type) {
    switch (type) {
      case Scalar::kInt8:
        return next<std::int8_t>();
      case Scalar::kUint8:
        return next<std::uint8_t>();
      case Scalar::kInt16:
        return next<std::int16_t>();
      case Scalar::kUint16:
        return next<std::uint16_t>();
      case Scalar::kInt32:
        return next<std::int32_t>();
      case Scalar::kUint32:
        return next<std::uint32_t>();
      default:
        throw BodyFault{"its faces list real numbers"};
    }
  }

  void skip(Scalar type) { take(scalar_bytes(type)); }

 private:
  template <class Number>
  Number next() {
    return load<Number>(take(sizeof(Number)), order_);
  }

  const char* take(std::size_t bytes) {
    if (rest_.size() < bytes) throw BodyFault{"the file is cut short"};
    const char* taken = rest_.data();
    rest_.remove_prefix(bytes);
    return taken;
  }

  std::string_view rest_;
  std::endian order_;
};

/// What a vertex's property means here; the first six are in the order of a vertex's numbers.
enum Role { kX, kY, kZ, kRed, kGreen, kBlue, kRoles, kNoRole };

Role role_of(const Property& property) {
  constexpr std::string_view kNames[kRoles] = {"x", "y", "z", "red", "green", "blue"};
  if (property.is_list) return kNoRole;
  for (int role = 0; role < kRoles; ++role)
    if (property.name == kNames[role]) return static_cast<Role>(role);
  return kNoRole;
}

/// The largest value of a colour channel: real numbers go to one, whole ones as far as they can.
double full_scale(Scalar type) {
  switch (type) {
    case Scalar::kUint8:
    case Scalar::kInt8:
      return 255;
    case Scalar::kUint16:
    case Scalar::kInt16:
      return 65535;
    case Scalar::kUint32:
    case Scalar::kInt32:
      return 4294967295.0;
    default:
      return 1;
  }
}

bool is_corner_list(const Property& property) {
  return property.is_list && (property.name == "vertex_indices" || property.name == "vertex_index");
}

template <class Body>
class BodyReader {
 public:
  BodyReader(const std::string& path, Body body) : path_(path), body_(body) {}

  TriangleMesh read(const Header& header) {
    bool has_strips = false;
    for (const Element& element : header.elements) {
      place_ = element.name;
      entry_ = 0;
      try {
        require_room(element);
        if (element.name == "vertex") {
          read_vertices(element);
        } else if (element.name == "face") {
          read_faces(element);
        } else {
          has_strips |= element.name == "tristrips";
          skip(element);
        }
      } catch (const BodyFault& fault) {
        throw bad_input(path_,
                        quoted(place_) + " " + std::to_string(entry_) + ": " + fault.sentence);
      }
    }
    finish(has_strips);
    return std::move(mesh_);
  }

 private:
  /// Before anything is made or walked: a header's count is free, bytes are not.
  void require_room(const Element& element) const {
    std::size_t entry_bytes = 0;
    for (const Property& p : element.properties)
      entry_bytes += Body::bytes_of(p.is_list ? p.count_type : p.type);
    if (entry_bytes == 0 || element.count <= body_.bytes_left() / entry_bytes) return;
    throw bad_input(path_, "is cut short: it promises " + std::to_string(element.count) +
                               " entries of " + quoted(element.name) + " and has bytes for " +
                               std::to_string(body_.bytes_left() / entry_bytes) + " at most");
  }

  void read_vertices(const Element& element) {
    if (!mesh_.vertices.empty()) throw bad_input(path_, "has two lists of vertices");
    if (element.count > kMaxMeshVertices)
      throw Error(ErrorCode::kOverLimit, path_ + ": has over 134 million vertices");
    std::vector<Role> roles;
    double scale[kRoles] = {};
    for (const Property& property : element.properties) {
      roles.push_back(role_of(property));
      if (roles.back() == kNoRole) continue;
      scale[roles.back()] = roles.back() < kRed ? 1 : full_scale(property.type);
    }
    if (!(scale[kX] > 0 && scale[kY] > 0 && scale[kZ] > 0))
      throw bad_input(path_, "has vertices without x, y and z");
    const bool has_colors = scale[kRed] > 0 && scale[kGreen] > 0 && scale[kBlue] > 0;
    mesh_.vertices.reserve(element.count);
    for (; entry_ < element.count; ++entry_) {
      float numbers[kRoles] = {};
      for (std::size_t p = 0; p < roles.size(); ++p) {
        if (roles[p] == kNoRole)
          skip(element.properties[p]);
        else
          numbers[roles[p]] =
              static_cast<float>(body_.real(element.properties[p].type) / scale[roles[p]]);
      }
      for (int c = kX; c <= kZ; ++c)
        if (!std::isfinite(numbers[c])) throw BodyFault{"has a coordinate that is not finite"};
      mesh_.vertices.push_back({numbers[kX], numbers[kY], numbers[kZ]});
      if (has_colors)
        mesh_.vertex_colors.push_back(
            linear_color({numbers[kRed], numbers[kGreen], numbers[kBlue]}));
    }
  }

  void read_faces(const Element& element) {
    if (std::none_of(element.properties.begin(), element.properties.end(), is_corner_list))
      return skip(element);
    for (; entry_ < element.count; ++entry_)
      for (const Property& property : element.properties)
        if (is_corner_list(property))
          read_face(property);
        else
          skip(property);
  }

  void read_face(const Property& property) {
    const std::int64_t corners = list_size(property);
    if (corners < 3) throw BodyFault{"a face needs three corners"};
    std::uint32_t first = 0, last = 0;
    for (std::int64_t i = 0; i < corners; ++i) {
      const std::int64_t corner = body_.whole(property.type);
      if (corner < 0 || corner >= static_cast<std::int64_t>(kMaxMeshVertices)) no_such(corner);
      const auto vertex = static_cast<std::uint32_t>(corner);
      largest_ = std::max(largest_, vertex);
      if (i == 0) first = vertex;
      if (i >= 2) {
        if (mesh_.triangles.size() == kMaxMeshTriangles)
          throw Error(ErrorCode::kOverLimit, path_ + ": has over 178 million triangles");
        mesh_.triangles.push_back({{first, last, vertex}});
      }
      last = vertex;
    }
  }

  std::int64_t list_size(const Property& property) {
    const std::int64_t size = body_.whole(property.count_type);
    if (size < 0) throw BodyFault{"has a list of a negative length"};
    return size;
  }

  void skip(const Property& property) {
    if (!property.is_list) return body_.skip(property.type);
    for (std::int64_t left = list_size(property); left > 0; --left) body_.skip(property.type);
  }

  void skip(const Element& element) {
    if (element.properties.empty()) return;
    for (; entry_ < element.count; ++entry_)
      for (const Property& property : element.properties) skip(property);
  }

  [[noreturn]] void no_such(std::int64_t corner) const {
    throw bad_input(path_, "a face has the corner " + std::to_string(corner) +
                               ", which the file has no vertex for");
  }

  void finish(bool has_strips) const {
    if (mesh_.triangles.empty())
      throw bad_input(path_, has_strips ? "has triangle strips, which cannot be read; export faces"
                                        : "has no faces");
    if (largest_ >= mesh_.vertices.size()) no_such(largest_);
  }

  const std::string& path_;
  Body body_;
  std::string place_;        ///< the element that is read
  std::uint64_t entry_ = 0;  ///< of it
  std::uint32_t largest_ = 0;
  TriangleMesh mesh_;
};

}  // namespace

TriangleMesh parse_ply(const std::string& path, std::string_view file) {
  const Header header = HeaderParser(path, file).parse();
  const std::string_view rest = file.substr(header.body);
  if (header.encoding == Encoding::kText)
    return BodyReader<TextBody>(path, TextBody(rest)).read(header);
  const bool is_big = header.encoding == Encoding::kBigEndian;
  const BinaryBody body(rest, is_big ? std::endian::big : std::endian::little);
  return BodyReader<BinaryBody>(path, body).read(header);
}

}  // namespace mdk
