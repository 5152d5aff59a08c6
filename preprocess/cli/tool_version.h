// Which mdprep this is.
#pragma once

#include <array>
#include <cstdint>
#include <string>

namespace mdk {

/// Major, minor, patch.
std::array<std::uint16_t, 3> tool_version();

/// "1.2.3"
std::string version_text(const std::array<std::uint16_t, 3>& version);

}  // namespace mdk
