// Words and numbers of a text, as every reader of texts cuts and reads them.
#pragma once

#include <charconv>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <type_traits>

#include "common/base/printable_text.h"

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

}  // namespace mdk
