// Text that people write and read: strict reading of numbers, sizes and words, tables with aligned
// columns, figures (figure_text.h), and which mdprep this is.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/error.h"
#include "common/base/text.h"

namespace mdk {

/// An Error (kUsage) about one value: "expected " and `what`. Whoever knows where the value stands
/// puts its name before it: see with_name().
Error expected(const std::string& what);

/// Returns work(), and puts "NAME: " before the sentence of an Error it throws.
template <class Work>
auto with_name(const std::string& name, Work work) {
  try {
    return work();
  } catch (const Error& error) {
    throw Error(error.code(), name + ": " + error.what());
  }
}

/// Both ends belong to it.
struct CountRange {
  std::uint32_t lowest = 1;
  std::uint32_t highest = 0xffffffffu;
};

/// The whole of `text` as a whole number in `range`. Throws Error (kUsage), as all below do.
std::uint32_t parse_count(std::string_view text, CountRange range);

/// Whether the whole of `text` is a finite number, and which.
bool read_real(std::string_view text, double& value);

/// The same, or an Error.
double parse_real(std::string_view text);

/// Makes a function that takes a whole number in `range`.
inline auto count_in(CountRange range) {
  return [range](std::string_view text) { return parse_count(text, range); };
}

/// Makes a function that takes a number that fits, and else says that it expected `what`.
template <class Condition>
auto real_where(Condition fits, std::string what) {
  return [fits, what = std::move(what)](std::string_view text) {
    double value = 0;
    if (!read_real(text, value) || !fits(value)) throw expected(what);
    return value;
  };
}

/// Makes a function that takes `word`, which stands for nothing, or what `parser` takes.
template <class Parser>
auto unless(std::string_view word, Parser parser) {
  return [word, parser](std::string_view text) {
    return text == word ? std::nullopt : std::optional(parser(text));
  };
}

/// "1500000", "512M", "1.5G": bytes, or KiB, MiB, GiB, TiB as K, M, G, T; above 0.
std::uint64_t parse_size(std::string_view text);

/// One of few words and what it stands for.
template <class T>
struct Choice {
  std::string_view word;
  T value;
};

/// "a, b or c".
std::string listed(const std::vector<std::string_view>& words);

/// Makes a function that takes one of these words and returns what it stands for.
template <class T>
auto one_of(std::vector<Choice<T>> choices) {
  return [choices = std::move(choices)](std::string_view text) {
    std::vector<std::string_view> words;
    for (const Choice<T>& choice : choices) {
      if (choice.word == text) return choice.value;
      words.push_back(choice.word);
    }
    throw expected(listed(words));
  };
}

/// The parts between separators, empty ones included.
std::vector<std::string> split(std::string_view text, char separator);

/// Sixteen hexadecimal digits.
std::string hash_text(std::uint64_t hash);

/// The shortest digits that give the number back: "0.1", "24".
std::string shortest_text(double value);

/// As parse_size() reads it: "2048M" where it is whole, else bytes.
std::string size_text(std::uint64_t bytes);

/// Major, minor, patch of this mdprep.
std::array<std::uint16_t, 3> tool_version();

/// "1.2.3"
std::string version_text(const std::array<std::uint16_t, 3>& version);

/// Rows of text with aligned columns.
class TextTable {
 public:
  /// The first `left_columns` columns are aligned to the left, the others, numbers, to the right.
  explicit TextTable(std::size_t left_columns) : left_columns_(left_columns) {}

  /// Rows may have different lengths.
  void add_row(std::vector<std::string> cells) { rows_.push_back(std::move(cells)); }

  /// Two spaces between columns, none at the ends of lines. Bytes count as characters.
  void print(std::ostream& out) const;

 private:
  std::size_t left_columns_;
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace mdk
