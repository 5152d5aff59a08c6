// Text from outside, made fit for one line of a terminal.
#pragma once

#include <string>

namespace mdk {

/// Control characters, which names in files may hold and terminals obey, become '?'.
inline std::string printable_line(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  return text;
}

}  // namespace mdk
