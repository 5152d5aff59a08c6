// Does every technique see what brute force sees?
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/base/progress.h"
#include "common/motion/model.h"
#include "preprocess/cli/check_result.h"

namespace mdk {

struct HitCheckConfig {
  std::uint32_t side = 128;  ///< pixels, of square pictures
  std::uint32_t keys = 4;    ///< spread over all clips
};

/// One result per technique of ours but brute force (peers judge nothing); failures are pixels
/// whose hit is another triangle or distance. Looks from three cameras (all in the picture; close,
/// from behind and below; from inside the bounds) at keys and at each of `between`.
std::vector<CheckResult> check_hits(const Model& model, const HitCheckConfig& config,
                                    std::span<const KeyInterval> between, ProgressSink& progress);

}  // namespace mdk
