// Resolution while things move: how much coarser than the window a picture is traced.
#pragma once

#include <cstdint>

#include "viewer/state/view_state.h"

namespace mdk {

enum class Motion { kStill, kDragging };

/// Window pixels per traced pixel along each side: 1, 2 or 4. `full_ms` is what a picture at full
/// resolution is expected to take; only kAuto asks for it.
std::uint32_t picture_divisor(Resolution resolution, Motion motion, double full_ms);

}  // namespace mdk
