// The body is one row of numbers, words or bytes alike. Two inputs give the next number, and one
// reader, for either, knows what the header says each number is.
#include "formats/ply_reader.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>
#include <utility>

#include "common/base/error.h"
#include "formats/files/mapped_file.h"
#include "formats/ply_header.h"
#include "formats/files/text.h"

namespace mdk {
namespace {

using namespace ply;

/// Why a body cannot be read on; the reader knows where.
struct BodyFault {
  std::string sentence;
};

/// Numbers as words, blanks and line breaks between them.
class TextBody {
 public:
  explicit TextBody(std::string_view rest) : rest_(rest) {}

  /// What one number takes at least, with the blank after it.
  static constexpr std::size_t bytes_of(Scalar) { return 2; }
  std::size_t bytes_left() const { return rest_.size() + 1; }  // the last blank may be missing

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

  static bool is_gap(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

  std::string_view next() {
    while (!rest_.empty() && is_gap(rest_.front())) rest_.remove_prefix(1);
    std::size_t size = 0;
    while (size < rest_.size() && !is_gap(rest_[size])) ++size;
    if (size == 0) throw BodyFault{"the file is cut short"};
    const std::string_view word = rest_.substr(0, size);
    rest_.remove_prefix(size);
    return word;
  }

  std::string_view rest_;
};

/// Numbers as bytes, one after the other.
class BinaryBody {
 public:
  BinaryBody(std::string_view rest, Encoding encoding)
      : rest_(rest), is_big_(encoding == Encoding::kBigEndian) {}

  static std::size_t bytes_of(Scalar type) { return scalar_bytes(type); }
  std::size_t bytes_left() const { return rest_.size(); }

  double real(Scalar type) {
    if (type == Scalar::kFloat64) return std::bit_cast<double>(next(8));
    if (type == Scalar::kFloat32)
      return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(next(4))));
    return static_cast<double>(whole(type));
  }

  std::int64_t whole(Scalar type) {
    switch (type) {
      case Scalar::kInt8:
        return static_cast<std::int8_t>(next(1));
      case Scalar::kInt16:
        return static_cast<std::int16_t>(next(2));
      case Scalar::kInt32:
        return static_cast<std::int32_t>(next(4));
      case Scalar::kFloat32:
      case Scalar::kFloat64:
        throw BodyFault{"its faces list real numbers"};
      default:
        return static_cast<std::int64_t>(next(scalar_bytes(type)));
    }
  }

  void skip(Scalar type) { next(scalar_bytes(type)); }

 private:
  std::uint64_t next(std::size_t bytes) {
    if (rest_.size() < bytes) throw BodyFault{"the file is cut short"};
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < bytes; ++i) {
      const std::size_t shift = is_big_ ? 8 * (bytes - 1 - i) : 8 * i;
      value |= std::uint64_t{static_cast<unsigned char>(rest_[i])} << shift;
    }
    rest_.remove_prefix(bytes);
    return value;
  }

  std::string_view rest_;
  bool is_big_;
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

TriangleMesh read_ply(const std::string& path) {
  const MappedFile file(path);
  const std::span<const std::byte> bytes = file.bytes();
  return parse_ply(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

TriangleMesh parse_ply(const std::string& path, std::string_view file) {
  const Header header = parse_header(path, file);
  const std::string_view rest = file.substr(header.body);
  if (header.encoding == Encoding::kText)
    return BodyReader<TextBody>(path, TextBody(rest)).read(header);
  return BodyReader<BinaryBody>(path, BinaryBody(rest, header.encoding)).read(header);
}

}  // namespace mdk
