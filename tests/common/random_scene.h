// Scenes of random numbers: instances standing and moving, of all wraps and speeds, mirrored,
// turned and scaled.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/scene/scene.h"

namespace mdk::test {

/// Vertices that move at random through two clips of uneven keys. No triangles: enough to ask where
/// they are.
Model random_points(std::uint32_t vertices, std::uint64_t seed);

/// Instances of random clips of the models within `reach` of the origin, half of them on paths of
/// up to a minute, as rough as they may be.
SceneStorage random_scene(std::span<const Model> models, std::uint32_t instances, float reach,
                          std::uint64_t seed);

}  // namespace mdk::test
