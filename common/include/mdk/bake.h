// Baking from memory: an animated mesh becomes a model, as by `mdprep bake`.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "mdk/model.h"

namespace mdk {

/// An animated mesh of K keys, V vertices and T triangles, all in the caller's memory.
struct BakeMesh {
  std::size_t key_count = 0, vertex_count = 0, triangle_count = 0;
  const float* vertices = nullptr;           ///< K * V * 3, key-major, finite
  const std::uint32_t* triangles = nullptr;  ///< T * 3, below V, counter-clockwise from outside
  const double* key_times = nullptr;         ///< K, rising, from any time; null: keys at `fps`
  double fps = 30;                           ///< keys a second, where key_times is null
  std::string clip_name = "clip";
};

struct BakeOptions {
  std::uint32_t clusters = 0;  ///< exactly so many; 0: as many as pay
  std::uint32_t segments = 0;  ///< stretches of time with boxes of their own; 0: as many as pay
  double quantize = 0;         ///< positions may be so far off, in rest pose diagonals; 0: exact
  unsigned threads = 0;        ///< 0: all cores
};

/// Splits the motion into clusters and builds structures that hold at every time (GFW06 §3). Copies
/// the mesh; vertices that move alike are joined. The result depends on mesh and options alone.
/// Throws Error: kUsage (an option, a null list), kBadInput (counts, a number that is not finite, a
/// corner that is no vertex, times that do not rise), kOverLimit. Cost: seconds for 10^4 triangles
/// and 100 keys.
Model bake(const BakeMesh& mesh, const BakeOptions& options = {});

/// Writes a model as a .mdk file, whole or not at all. Throws Error (kIo).
void save(const Model& model, const std::string& path);

}  // namespace mdk
