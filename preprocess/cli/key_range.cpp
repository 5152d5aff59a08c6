#include "preprocess/cli/key_range.h"

#include <algorithm>

#include "common/base/error.h"
#include "preprocess/cli/number_text.h"

namespace mdk {
namespace {

/// [first, last) of the last run of '#' in the file name; both npos where there is none.
struct NumberPlace {
  std::size_t first = std::string::npos, last = std::string::npos;
};

NumberPlace find_number_place(const std::string& pattern) {
  const std::size_t slash = pattern.rfind('/');
  const std::size_t name = slash == std::string::npos ? 0 : slash + 1;
  const std::size_t at = pattern.rfind('#');
  if (at == std::string::npos || at < name) return {};
  std::size_t first = at;
  while (first > name && pattern[first - 1] == '#') --first;
  return {first, at + 1};
}

}  // namespace

std::vector<std::uint32_t> parse_key_range(std::string_view text, std::uint32_t key_count) {
  const std::vector<std::string> parts = split(text, ':');
  if (parts.size() > 3)
    throw Error(ErrorCode::kUsage,
                "--frames " + std::string(text) + ": expected A:B or A:B:S, as in 0:29:2");
  constexpr CountRange kAnyKey{0, 0xffffffffu};
  const std::uint32_t first = parse_count("--frames", parts[0], kAnyKey);
  const std::uint32_t last = parts.size() > 1 ? parse_count("--frames", parts[1], kAnyKey) : first;
  const std::uint32_t step = parts.size() > 2 ? parse_count("--frames", parts[2], {}) : 1;
  if (first > last)
    throw Error(ErrorCode::kUsage, "--frames " + std::string(text) +
                                       ": the first key lies past the last; write the smaller one "
                                       "first");
  if (last >= key_count)
    throw Error(ErrorCode::kUsage, "--frames " + std::string(text) + ": the file has keys 0 to " +
                                       std::to_string(key_count - 1));
  std::vector<std::uint32_t> keys;
  for (std::uint64_t key = first; key <= last; key += step)
    keys.push_back(static_cast<std::uint32_t>(key));
  return keys;
}

std::vector<std::uint32_t> spread_keys(std::uint32_t wanted, std::uint32_t key_count) {
  const std::uint64_t count = std::min(wanted, key_count);
  std::vector<std::uint32_t> keys;
  for (std::uint64_t i = 0; i < count; ++i)
    keys.push_back(count == 1 ? 0 : static_cast<std::uint32_t>(i * (key_count - 1) / (count - 1)));
  return keys;
}

bool has_number_place(const std::string& pattern) {
  return find_number_place(pattern).first != std::string::npos;
}

std::string numbered_path(const std::string& pattern, std::uint32_t number) {
  const NumberPlace place = find_number_place(pattern);
  if (place.first == std::string::npos) return pattern;
  std::string digits = std::to_string(number);
  const std::size_t width = place.last - place.first;
  if (digits.size() < width) digits.insert(0, width - digits.size(), '0');
  return pattern.substr(0, place.first) + digits + pattern.substr(place.last);
}

}  // namespace mdk
