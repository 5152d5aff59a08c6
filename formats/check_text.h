// Sentences and predicates that the checks of a model share.
#pragma once

#include <cmath>
#include <cstdint>
#include <string>

#include "common/math/affine3.h"

namespace mdk {

inline std::string number(std::uint64_t value) { return std::to_string(value); }

/// "fuzzy_boxes: 7 of them, not 12", or nothing.
inline std::string count_fault(const char* name, std::uint64_t count, std::uint64_t wanted) {
  if (count == wanted) return {};
  return std::string(name) + ": " + number(count) + " of them, not " + number(wanted);
}

inline bool is_finite(const Affine3f& map) {
  bool ok = true;
  for (const auto& row : map.m) {
    for (const float entry : row) ok &= std::isfinite(entry);
  }
  return ok;
}

}  // namespace mdk
