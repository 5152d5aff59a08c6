// Picture: pixels made on the CPU.
#pragma once

#include <cstdint>
#include <vector>

namespace mdk {

/// sRGB RGBA, width * height, row 0 on top.
struct Picture {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint32_t> pixels;
};

}  // namespace mdk
