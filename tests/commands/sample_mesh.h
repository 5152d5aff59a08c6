// A small animated glTF for tests: a tube that two bones bend, and a cube that a node swings round
// it. Clips "bend" (1 s) and "swing" (0.5 s): 31 + 16 keys at 30 a second.
#pragma once

#include <string>

namespace mdk::test {

struct TubeShape {
  int rings = 12;
  int sides = 16;

  int triangles() const { return 2 * rings * sides + 12; }
};

inline constexpr int kSampleKeys = 47;

/// Writes `path` (a .gltf) and its buffer beside it, named as the file with .bin at the end.
void write_sample_gltf(const std::string& path, const TubeShape& shape = {});

}  // namespace mdk::test
