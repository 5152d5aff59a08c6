// Shutter: the moments at which the samples of a frame are taken, for motion blur.
#pragma once

#include <cstdint>
#include <vector>

#include "common/motion/model.h"

namespace mdk {

/// One moment per sample, spread evenly over `open` seconds with `seconds` of the clip in their
/// middle, which is the first one's; in an order that has nothing to do with where in their pixel
/// the samples are. Times outside the clip are clamped to it.
std::vector<KeyInterval> shutter_moments(const Model& model, std::uint32_t clip, double seconds,
                                         double open, std::uint32_t samples);

}  // namespace mdk
