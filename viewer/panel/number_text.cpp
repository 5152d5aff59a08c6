#include "viewer/panel/number_text.h"

#include <array>
#include <cmath>
#include <cstdio>

namespace mdk {
namespace {

std::string fixed(double value, int decimals) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.*f", decimals, value);
  return text.data();
}

}  // namespace

std::string grouped(std::uint64_t count) {
  std::string text = std::to_string(count);
  for (std::size_t at = text.size(); at > 3; at -= 3) text.insert(at - 3, 1, ',');
  return text;
}

std::string bytes_text(std::uint64_t bytes) {
  constexpr std::array kUnits = {"KiB", "MiB", "GiB", "TiB"};
  if (bytes < 1024) return std::to_string(bytes) + " B";
  double value = static_cast<double>(bytes) / 1024;
  std::size_t unit = 0;
  for (; value >= 1024 && unit + 1 < kUnits.size(); ++unit) value /= 1024;
  return fixed(value, value < 100 ? 1 : 0) + " " + kUnits[unit];
}

std::string short_number(double value) {
  return fixed(value, value < 9.995 ? 2 : value < 99.95 ? 1 : 0);
}

std::string milliseconds_text(double ms) { return short_number(ms) + " ms"; }

std::string rate_text(double per_second) {
  if (per_second >= 1e9) return fixed(per_second / 1e9, 2) + " G";
  if (per_second >= 1e6) return fixed(per_second / 1e6, per_second < 1e8 ? 1 : 0) + " M";
  if (per_second >= 1e3) return fixed(per_second / 1e3, 0) + " k";
  return fixed(per_second, 0);
}

}  // namespace mdk
