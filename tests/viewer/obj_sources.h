// Sources that a viewer has baked: one that takes no time, one that takes long.
#pragma once

#include <string>

namespace mdk::test {

inline constexpr const char* kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";

/// A sheet of side * side squares: with hundreds, many seconds of work for a baker.
inline std::string large_obj(int side) {
  std::string text;
  for (int y = 0; y <= side; ++y)
    for (int x = 0; x <= side; ++x)
      text += "v " + std::to_string(x) + " " + std::to_string(y) + " " +
              std::to_string((x * y) % 7) + "\n";
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const int a = y * (side + 1) + x + 1;
      text += "f " + std::to_string(a) + " " + std::to_string(a + 1) + " " +
              std::to_string(a + side + 2) + " " + std::to_string(a + side + 1) + "\n";
    }
  return text;
}

}  // namespace mdk::test
