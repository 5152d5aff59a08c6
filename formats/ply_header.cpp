// "ply" | "format ascii|binary_… 1.0" | ("element NAME COUNT" | "property TYPE NAME" |
// "property list COUNT_TYPE TYPE NAME" | "comment …" | "obj_info …")* | "end_header".
#include "formats/ply_header.h"

#include <array>
#include <optional>
#include <utility>

#include "common/base/error.h"
#include "formats/files/text.h"

namespace mdk::ply {
namespace {

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

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

class HeaderParser {
 public:
  HeaderParser(const std::string& path, std::string_view file) : path_(path), file_(file) {}

  Header parse() {
    if (!next_line() || next_word() != "ply")
      throw bad_input(path_, "is not a PLY file: its first line is not \"ply\"");
    bool has_format = false;
    while (next_line()) {
      const std::string_view keyword = next_word();
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
    rest_ = file_.substr(at_, end - at_);
    at_ = end + 1;
    ++line_;
    return true;
  }

  std::string_view next_word() {
    while (!rest_.empty() && is_blank(rest_.front())) rest_.remove_prefix(1);
    std::size_t size = 0;
    while (size < rest_.size() && !is_blank(rest_[size])) ++size;
    const std::string_view word = rest_.substr(0, size);
    rest_.remove_prefix(size);
    return word;
  }

  Scalar next_type() {
    const std::string_view word = next_word();
    for (const ScalarName& known : kScalarNames)
      if (known.name == word) return known.type;
    fail(quoted(word) + " is no type of a PLY property");
  }

  void read_format() {
    const std::string_view name = next_word(), version = next_word();
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
    const std::string_view name = next_word(), count = next_word();
    const std::optional<std::uint64_t> number = parsed<std::uint64_t>(count);
    if (name.empty() || !number) fail("an element needs a name and a count");
    header_.elements.push_back({std::string(name), *number, {}});
  }

  void read_property() {
    if (header_.elements.empty()) fail("a property comes before the first element");
    Property property;
    const std::string_view before = rest_;
    property.is_list = next_word() == "list";
    if (property.is_list) {
      property.count_type = next_type();
      if (property.count_type == Scalar::kFloat32 || property.count_type == Scalar::kFloat64)
        fail("a list cannot count in real numbers");
    } else {
      rest_ = before;
    }
    property.type = next_type();
    property.name = next_word();
    if (property.name.empty()) fail("a property needs a name");
    header_.elements.back().properties.push_back(std::move(property));
  }

  const std::string& path_;
  std::string_view file_;
  std::string_view rest_;  ///< of the line
  std::size_t at_ = 0;     ///< start of the next line
  std::size_t line_ = 0;
  Header header_;
};

}  // namespace

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

Header parse_header(const std::string& path, std::string_view file) {
  return HeaderParser(path, file).parse();
}

}  // namespace mdk::ply
