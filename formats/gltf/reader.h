// Reads animated glTF 2.0 (.gltf, .glb) as one pose sequence.
#pragma once

#include <string>
#include <vector>

#include "common/base/parallel.h"
#include "formats/reading.h"

namespace mdk {

/// Everything visible in the default scene becomes one mesh: skins, morph targets, animated nodes,
/// static parts. Each animation becomes a clip whose keys are sampled at start + i / fps, and at
/// its end; a file without animations becomes one clip with one key. World space, +y up, metres, as
/// in the file. Throws Error: kIo (cannot read), kBadInput (broken, or needs a feature that is
/// named), kUsage (no clip of such a name; lists those there are), kOverLimit.
ReadResult read_gltf(const std::string& path, const ReadOptions& options, ProgressSink& progress);

/// The same for a binary glTF in memory, which was made from the file `path`: it is named in
/// messages, is no dependency, and images are looked for beside it.
ReadResult read_glb(const std::string& path, const std::vector<unsigned char>& bytes,
                    const ReadOptions& options, ProgressSink& progress);

}  // namespace mdk
