// Notes of a reader: sentences about what is left out, each once, in the order they came up.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "common/base/text.h"

namespace mdk {

inline void add_note(std::vector<std::string>& notes, const std::string& sentence) {
  const std::string line = printable_line(sentence);
  if (std::ranges::find(notes, line) == notes.end()) notes.push_back(line);
}

}  // namespace mdk
