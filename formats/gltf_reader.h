// Reads animated glTF 2.0 (.gltf, .glb) as one pose sequence.
#pragma once

#include <string>
#include <vector>

#include "common/base/progress.h"
#include "common/motion/pose_sequence.h"

namespace mdk {

struct GltfOptions {
  double fps = 30;                 ///< sampling rate, keys per second, in (0, 10000]
  std::vector<std::string> clips;  ///< names of the animations to read; empty: all
  bool skeleton = false;           ///< keep what the rig's bones hang on; then no bones are joined
};

struct GltfResult {
  PoseSequence sequence;
  std::vector<std::string> dependencies;  ///< every file read: the input, buffers, images
  std::vector<std::string> notes;         ///< one sentence per thing left out ("morph normals…")
};

/// Everything visible in the default scene becomes one mesh: skins, morph targets, animated nodes,
/// static parts. Each animation becomes a clip whose keys are sampled at start + i / fps, and at
/// its end; a file without animations becomes one clip with one key. World space, +y up, metres, as
/// in the file. Throws Error: kIo (cannot read), kBadInput (broken, or needs a feature that is
/// named), kUsage (no clip of such a name; lists those there are), kOverLimit.
GltfResult read_gltf(const std::string& path, const GltfOptions& options, ProgressSink& progress);

}  // namespace mdk
