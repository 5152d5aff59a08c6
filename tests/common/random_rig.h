// Rigs of random numbers.
#pragma once

#include <cstdint>

#include "common/motion/rig.h"

namespace mdk {

struct RigSize {
  std::uint32_t vertices = 10, keys = 3, bones = 5, targets = 3;
};

/// Up to 4 weights per vertex that sum to one, a bone perhaps twice; up to 2 offsets.
Rig random_rig(const RigSize& size, std::uint32_t seed);

}  // namespace mdk
