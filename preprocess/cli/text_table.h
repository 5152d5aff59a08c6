// TextTable: rows of text with aligned columns, for people.
#pragma once

#include <cstddef>
#include <iosfwd>
#include <string>
#include <vector>

namespace mdk {

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
