// Moved.
#pragma once

#include "preprocess/tool/text.h"

namespace mdk {

/// As parse_size() of one text, with the option's name in front of what is wrong.
inline std::uint64_t parse_size(std::string_view option, std::string_view text) {
  try {
    return parse_size(text);
  } catch (const Error& error) {
    throw Error(error.code(), std::string(option) + " " + std::string(text) + ": " + error.what());
  }
}

}  // namespace mdk
