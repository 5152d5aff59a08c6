// Words and numbers of a text, as every reader of texts cuts and reads them; and UTF-8, which names
// in a .mdk are, while those of files on a disk are any bytes.
#pragma once

#include <charconv>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <type_traits>

#include "common/base/text.h"

namespace mdk {

/// The whole word as a number, rounded correctly and so alike on every machine; a real number too
/// small to be told from zero is zero. Nothing where the word is something else, or out of range.
template <class Number>
std::optional<Number> parsed(std::string_view word) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  Number value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (end != word.data() + word.size()) return std::nullopt;
  if constexpr (std::is_floating_point_v<Number>) {
    const bool is_tiny = word.find("e-") != word.npos || word.find("E-") != word.npos;
    if (error == std::errc::result_out_of_range && is_tiny) return Number{0};
  }
  if (error != std::errc()) return std::nullopt;
  return value;
}

/// Not more of a word than a message can hold, and nothing that would cut the message short.
inline std::string quoted(std::string_view word) {
  std::string text(1, '"');
  text.append(printable_line(std::string(word.substr(0, 40))));
  return text.append(1, '"');
}

/// No stray continuation, overlong form, surrogate or value past U+10FFFF.
inline bool is_utf8(const std::string& text) {
  for (std::size_t i = 0; i < text.size();) {
    const auto lead = static_cast<unsigned char>(text[i++]);
    if (lead < 0x80) continue;
    const int more = lead >= 0xf0 ? 3 : lead >= 0xe0 ? 2 : 1;
    if (lead < 0xc2 || lead > 0xf4) return false;
    std::uint32_t value = lead & (0x3fu >> more);
    for (int k = 0; k < more; ++k, ++i) {
      if (i == text.size() || (static_cast<unsigned char>(text[i]) & 0xc0) != 0x80) return false;
      value = (value << 6) | (static_cast<unsigned char>(text[i]) & 0x3fu);
    }
    constexpr std::uint32_t kMin[] = {0, 0x80, 0x800, 0x10000};
    if (value < kMin[more] || value > 0x10ffff || (value >= 0xd800 && value < 0xe000)) return false;
  }
  return true;
}

/// The text, where it is UTF-8, else with '?' for every byte that is not ASCII.
inline std::string as_utf8(std::string text) {
  if (is_utf8(text)) return text;
  for (char& c : text)
    if (static_cast<unsigned char>(c) >= 0x80) c = '?';
  return text;
}

}  // namespace mdk
