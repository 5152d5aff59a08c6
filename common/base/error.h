// Sentences about files, as errors. Thrown at the edge where something is wrong, caught once in
// main.
#pragma once

#include <string>

#include "mdk/error.h"

namespace mdk {

/// "walk.glb: accessor 3 reaches past its buffer view": the file, then the sentence.
inline Error bad_input(const std::string& file, const std::string& sentence) {
  return {ErrorCode::kBadInput, file + ": " + sentence};
}
inline Error io_error(const std::string& file, const std::string& sentence) {
  return {ErrorCode::kIo, file + ": " + sentence};
}

}  // namespace mdk
