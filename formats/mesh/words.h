// Texts as words: of Wavefront files (.obj, .mtl) and of PLY.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string_view>

namespace mdk {

inline bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

/// In Wavefront files a backslash at the end of a line parts words, too.
inline bool is_blank_or_backslash(char c) { return is_blank(c) || c == '\\'; }

/// Cuts a text at its blanks, as `is_gap` knows them.
template <bool (*is_gap)(char)>
class Words {
 public:
  explicit Words(std::string_view text) : rest_(text) {}

  /// Empty at the end.
  std::string_view next() {
    skip_gaps();
    std::size_t size = 0;
    while (size < rest_.size() && !is_gap(rest_[size])) ++size;
    const std::string_view word = rest_.substr(0, size);
    rest_.remove_prefix(size);
    return word;
  }

  /// All that is left, as a name that may have blanks within.
  std::string_view rest() {
    skip_gaps();
    while (!rest_.empty() && is_gap(rest_.back())) rest_.remove_suffix(1);
    return rest_;
  }

  std::size_t bytes_left() const { return rest_.size(); }

 private:
  void skip_gaps() {
    while (!rest_.empty() && is_gap(rest_.front())) rest_.remove_prefix(1);
  }

  std::string_view rest_;
};

using StatementWords = Words<is_blank_or_backslash>;

/// Cuts a Wavefront text into statements (a keyword and words, mostly one to a line) and counts the
/// lines they start on.
class Statements {
 public:
  /// A byte order mark, which some editors put before UTF-8, is no part of the first.
  explicit Statements(std::string_view text) : rest_(text) {
    constexpr std::string_view kMark = "\xef\xbb\xbf";
    if (rest_.starts_with(kMark)) rest_.remove_prefix(kMark.size());
  }

  bool next(std::string_view& statement) {
    if (rest_.empty()) return false;
    line_ = next_line_;
    std::size_t end = 0;
    while (end < rest_.size()) {
      if (rest_[end] == '\n') {
        ++next_line_;
        if (!continues(end)) break;
      }
      ++end;
    }
    statement = rest_.substr(0, end);
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    return true;
  }
  std::size_t line() const { return line_; }

 private:
  bool continues(std::size_t end) const {
    while (end > 0 && rest_[end - 1] == '\r') --end;
    return end > 0 && rest_[end - 1] == '\\';
  }

  std::string_view rest_;
  std::size_t line_ = 0, next_line_ = 1;
};

}  // namespace mdk
