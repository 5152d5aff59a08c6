// Assimp's animations as glTF animations.
#pragma once

#include <cstddef>
#include <span>

#include "formats/assimp/scene_import.h"

namespace mdk {

/// One glTF animation for each of the scene's that moves something. `target_counts`: per node, the
/// morph targets of what it shows. Times in ticks become seconds. Throws Error (kBadInput) for
/// numbers that are not finite.
void add_animations(SceneImport& import, std::span<const std::size_t> target_counts);

/// Per node, whether an animation moves it.
std::vector<char> moved_nodes(const SceneImport& import);

}  // namespace mdk
