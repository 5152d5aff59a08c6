// Dependencies in the form make and ninja read.
#pragma once

#include <span>
#include <string>

namespace mdk {

/// "out.mdk: a.gltf a.bin", one rule, with blanks, '#' and '$' in names escaped. Throws Error
/// (kUsage) for a name with a line break, which the form cannot hold.
std::string depfile_text(const std::string& target, std::span<const std::string> dependencies);

}  // namespace mdk
