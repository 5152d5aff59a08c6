// PLY files written number by number, in any of the three encodings.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>

namespace mdk::test {

enum class PlyEncoding { kText, kLittleEndian, kBigEndian };

/// A header line by line, then `number` after `number`.
class PlyBuilder {
 public:
  PlyBuilder(PlyEncoding encoding, const std::string& lines) : encoding_(encoding) {
    const char* const formats[] = {"ascii", "binary_little_endian", "binary_big_endian"};
    text_ = "ply\nformat " + std::string(formats[static_cast<int>(encoding)]) + " 1.0\n" + lines +
            "end_header\n";
  }

  template <class T>
  PlyBuilder& number(T value) {
    if (encoding_ == PlyEncoding::kText) {
      text_ += std::to_string(value) + " ";
      return *this;
    }
    char bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof(T));
    const bool is_native =
        (std::endian::native == std::endian::little) == (encoding_ == PlyEncoding::kLittleEndian);
    for (std::size_t i = 0; i < sizeof(T); ++i) text_ += bytes[is_native ? i : sizeof(T) - 1 - i];
    return *this;
  }

  const std::string& file() const { return text_; }

 private:
  PlyEncoding encoding_;
  std::string text_;
};

}  // namespace mdk::test
