// MdkOrigin: what made a .mdk file, as its header says.
#pragma once

#include <array>
#include <cstdint>

namespace mdk {

/// What read the source, as the file counts it.
enum class SourceReader : std::uint16_t { kMdprep = 0, kAssimp = 1 };

/// All zeros: not known.
struct MdkOrigin {
  std::array<std::uint16_t, 3> version = {};  ///< of the program: major, minor, patch
  std::uint64_t options_hash = 0;             ///< XXH3 of the options that shape the content
  SourceReader reader = SourceReader::kMdprep;

  bool operator==(const MdkOrigin&) const = default;
};

}  // namespace mdk
