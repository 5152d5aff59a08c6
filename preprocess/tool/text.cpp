#include "preprocess/tool/text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <ostream>

namespace mdk {
namespace {

/// Whether the whole of `text` is a number.
template <class Number>
bool read_number(std::string_view text, Number& value) {
  const char* end = text.data() + text.size();
  const auto [stop, problem] = std::from_chars(text.data(), end, value);
  return problem == std::errc{} && stop == end;
}

}  // namespace

Error expected(const std::string& what) { return {ErrorCode::kUsage, "expected " + what}; }

std::uint32_t parse_count(std::string_view text, CountRange range) {
  std::uint32_t value = 0;
  if (!read_number(text, value) || value < range.lowest || value > range.highest)
    throw expected("a whole number from " + std::to_string(range.lowest) + " to " +
                   std::to_string(range.highest));
  return value;
}

bool read_real(std::string_view text, double& value) {
  return read_number(text, value) && std::isfinite(value);
}

double parse_real(std::string_view text) {
  double value = 0;
  if (!read_real(text, value)) throw expected("a number");
  return value;
}

std::uint64_t parse_size(std::string_view text) {
  constexpr std::string_view kUnits = "KMGT";
  constexpr double kMaxSize = 0x1p60;
  const std::size_t unit = text.empty() ? std::string_view::npos : kUnits.find(text.back());
  const bool has_unit = unit != std::string_view::npos;
  double value = 0;
  const bool is_number = read_number(text.substr(0, text.size() - (has_unit ? 1 : 0)), value);
  if (has_unit) value = std::ldexp(value, 10 * static_cast<int>(unit + 1));
  if (!is_number || !(value >= 1 && value <= kMaxSize))
    throw expected("a size above 0, as in 1500000, 512M or 1.5G");
  return static_cast<std::uint64_t>(value);
}

std::string listed(const std::vector<std::string_view>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i)
    text.append(i == 0 ? "" : i + 1 == words.size() ? " or " : ", ").append(words[i]);
  return text;
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

std::string shortest_text(double value) {
  std::array<char, 32> digits{};
  const auto written = std::to_chars(digits.data(), digits.data() + digits.size(), value);
  return {digits.data(), written.ptr};
}

std::string size_text(std::uint64_t bytes) {
  constexpr std::uint64_t kMebibyte = std::uint64_t{1} << 20;
  return bytes % kMebibyte == 0 ? std::to_string(bytes / kMebibyte) + "M" : std::to_string(bytes);
}

std::array<std::uint16_t, 3> tool_version() {
  return {MDK_VERSION_MAJOR, MDK_VERSION_MINOR, MDK_VERSION_PATCH};
}

std::string version_text(const std::array<std::uint16_t, 3>& version) {
  return std::to_string(version[0]) + "." + std::to_string(version[1]) + "." +
         std::to_string(version[2]);
}

void TextTable::print(std::ostream& out) const {
  std::vector<std::size_t> widths;
  for (const std::vector<std::string>& row : rows_) {
    widths.resize(std::max(widths.size(), row.size()), 0);
    for (std::size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], row[c].size());
  }
  for (const std::vector<std::string>& row : rows_) {
    std::string line;
    for (std::size_t c = 0; c < row.size(); ++c) {
      const std::string padding(widths[c] - row[c].size(), ' ');
      line += c == 0 ? "" : "  ";
      line += c < left_columns_ ? row[c] + padding : padding + row[c];
    }
    line.erase(line.find_last_not_of(' ') + 1);
    out << line << '\n';
  }
}

}  // namespace mdk
