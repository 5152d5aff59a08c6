#include "common/base/text.h"

#include <cstdio>
#include <iterator>

namespace mdk {

std::string fixed_text(double value, int decimals) {
  char buffer[352];  // a double has at most 309 digits before the point
  std::snprintf(buffer, sizeof buffer, "%.*f", decimals < 20 ? decimals : 20, value);
  return buffer;
}

std::string grouped_text(std::uint64_t value) {
  std::string digits = std::to_string(value);
  for (std::size_t at = digits.size(); at > 3;) {
    at -= 3;
    digits.insert(at, 1, ',');
  }
  return digits;
}

std::string bytes_text(std::uint64_t bytes) {
  if (bytes < 1024) return std::to_string(bytes) + " B";
  static constexpr const char* kUnits[] = {"KiB", "MiB", "GiB", "TiB"};
  double value = static_cast<double>(bytes) / 1024;
  std::size_t unit = 0;
  while (value >= 1024 && unit + 1 < std::size(kUnits)) {
    value /= 1024;
    ++unit;
  }
  return fixed_text(value, 1) + " " + kUnits[unit];
}

std::string printable_line(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  return text;
}

}  // namespace mdk
