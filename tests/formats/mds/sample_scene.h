// A small scene made by hand: instances standing and on a path, of two models.
#pragma once

#include <string>
#include <vector>

#include "formats/mds/mds_file.h"

namespace mdk::test {

/// Five instances: each wrap once, two on one path, one on a path that hides.
SceneStorage sample_scene();

/// Writes the scene's two models into a folder, as "a.mdk" and "b.mdk", and says so.
std::vector<SceneModelFile> write_sample_models(const std::string& folder);

/// Asks a scene for what tracing asks: clocks, maps and boxes at several times. Returns a digest,
/// so that nothing of it is optimised away. The arrays are copied first, each into a block of its
/// own, where AddressSanitizer sees one step outside.
double walk_scene(const Stage& stage);

}  // namespace mdk::test
