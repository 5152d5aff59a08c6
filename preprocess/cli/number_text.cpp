#include "preprocess/cli/number_text.h"

#include <charconv>
#include <cmath>
#include <cstdio>

#include "common/base/error.h"

namespace mdk {

std::uint32_t parse_count(std::string_view option, std::string_view text, CountRange range) {
  std::uint32_t value = 0;
  const char* end = text.data() + text.size();
  const auto [stop, problem] = std::from_chars(text.data(), end, value);
  if (problem != std::errc{} || stop != end || value < range.lowest || value > range.highest)
    throw Error(ErrorCode::kUsage,
                std::string(option) + " " + std::string(text) + ": expected a whole number from " +
                    std::to_string(range.lowest) + " to " + std::to_string(range.highest));
  return value;
}

double parse_real(std::string_view option, std::string_view text) {
  double value = 0;
  const char* end = text.data() + text.size();
  const auto [stop, problem] = std::from_chars(text.data(), end, value);
  if (problem != std::errc{} || stop != end || !std::isfinite(value))
    throw Error(ErrorCode::kUsage,
                std::string(option) + " " + std::string(text) + ": expected a number");
  return value;
}

std::uint64_t parse_size(std::string_view option, std::string_view text) {
  constexpr std::string_view kUnits = "KMGT";
  constexpr double kMost = 0x1p60;
  const std::size_t unit = text.empty() ? std::string_view::npos : kUnits.find(text.back());
  const std::string_view digits =
      unit == std::string_view::npos ? text : text.substr(0, text.size() - 1);
  double value = 0;
  const auto [stop, problem] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  const bool is_number = problem == std::errc{} && stop == digits.data() + digits.size();
  if (unit != std::string_view::npos) value = std::ldexp(value, 10 * static_cast<int>(unit + 1));
  if (!is_number || !(value >= 1 && value <= kMost))
    throw Error(ErrorCode::kUsage, std::string(option) + " " + std::string(text) +
                                       ": expected a size above 0, as in 1500000, 512M or 1.5G");
  return static_cast<std::uint64_t>(value);
}

std::vector<std::string> split(std::string_view text, char separator) {
  std::vector<std::string> parts;
  while (true) {
    const std::size_t at = text.find(separator);
    parts.emplace_back(text.substr(0, at));
    if (at == std::string_view::npos) return parts;
    text.remove_prefix(at + 1);
  }
}

std::string hash_text(std::uint64_t hash) {
  char buffer[17];
  std::snprintf(buffer, sizeof buffer, "%016llx", static_cast<unsigned long long>(hash));
  return buffer;
}

}  // namespace mdk
