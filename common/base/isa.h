// Isa: which instruction set the SIMD kernels use.
#pragma once

#include <span>
#include <string_view>

namespace mdk {

/// Use no more than this: "sse4", "avx2", "avx512" or "neon". Throws Error (kUsage) for another
/// word or for a set this machine lacks. Call before any kernel has run, or between frames.
void limit_isa(std::string_view name);

/// Back to the best there is.
void reset_isa();

/// The set in use now, in the words above ("scalar" where there is no SIMD).
std::string_view isa_in_use();

/// The sets this machine has, weakest first.
std::span<const std::string_view> available_isas();

}  // namespace mdk
