// What every reader of animated meshes takes and gives.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "common/base/scratch.h"
#include "common/motion/pose_sequence.h"

namespace mdk {

struct ReadOptions {
  double fps = 30;                 ///< keys or frames per second, in (0, 10000]
  std::vector<std::string> clips;  ///< names of the animations to read; empty: all
  bool skeleton = false;           ///< keep what the rig's bones hang on; then no bones are joined
  std::size_t most_pose_bytes = std::size_t{16}
                                << 30;  ///< of glTF: what unfolds to more is refused
  ScratchSpace scratch = {};            ///< where the positions stand
};

struct ReadResult {
  PoseSequence sequence;
  std::vector<std::string> dependencies;  ///< every file read: the inputs, buffers, images
  std::vector<std::string> unread;        ///< files named in them that could not be read: images
  std::string read_through;  ///< what read it in this program's place ("Assimp 5.2.5"), if anything
  std::vector<std::string> notes;  ///< one sentence per thing left out ("morph normals…")
};

}  // namespace mdk
