// The head of a .ply file: a text that lists what the body holds, element after element.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace mdk::ply {

enum class Encoding { kText, kLittleEndian, kBigEndian };

enum class Scalar { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };

/// Bytes of one number in a binary body.
std::size_t scalar_bytes(Scalar type);

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

/// Reads the head of a whole file. Throws Error (kBadInput) with the line; `path` is for messages.
Header parse_header(const std::string& path, std::string_view file);

}  // namespace mdk::ply
