// Numbers in and out of text: strict reading of option values, and figures as people read them
// (figure_text.h).
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/figure_text.h"

namespace mdk {

/// Both ends belong to it.
struct CountRange {
  std::uint32_t lowest = 1;
  std::uint32_t highest = 0xffffffffu;
};

/// The whole of `text` as a whole number in `range`; throws Error (kUsage) naming `option`.
std::uint32_t parse_count(std::string_view option, std::string_view text, CountRange range);

/// The whole of `text` as a finite number; throws Error (kUsage) naming `option`.
double parse_real(std::string_view option, std::string_view text);

/// "1500000", "512M", "1.5G": bytes, or KiB, MiB, GiB, TiB as K, M, G, T; above 0. Throws Error
/// (kUsage) naming `option`.
std::uint64_t parse_size(std::string_view option, std::string_view text);

/// The parts between separators, empty ones included.
std::vector<std::string> split(std::string_view text, char separator);

/// Sixteen hexadecimal digits.
std::string hash_text(std::uint64_t hash);

}  // namespace mdk
