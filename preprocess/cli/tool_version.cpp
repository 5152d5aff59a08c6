#include "preprocess/cli/tool_version.h"

namespace mdk {

std::array<std::uint16_t, 3> tool_version() {
  return {MDK_VERSION_MAJOR, MDK_VERSION_MINOR, MDK_VERSION_PATCH};
}

std::string version_text(const std::array<std::uint16_t, 3>& version) {
  return std::to_string(version[0]) + "." + std::to_string(version[1]) + "." +
         std::to_string(version[2]);
}

}  // namespace mdk
