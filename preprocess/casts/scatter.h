// Scenes without a cast: instances in a pattern, their start times spread over the clips.
#pragma once

#include <cstdint>
#include <optional>

#include "preprocess/casts/cast.h"

namespace mdk {

enum class ScatterPattern { kGrid, kRows, kDisc, kStadium };

struct ScatterOptions {
  ScatterPattern pattern = ScatterPattern::kGrid;
  std::uint32_t count = 0;
  std::uint64_t seed = 1;
  std::optional<double> spacing;  ///< none: what the widest model needs
};

/// Models, places and headings as the pattern has them; clips (CastOptions::clip, or any that
/// moves) and start times at random, the same on every machine for the same seed.
void scatter(const ScatterOptions& scatter, const CastOptions& options, SceneBuilder& scene);

}  // namespace mdk
