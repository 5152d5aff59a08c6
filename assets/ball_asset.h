// Puts the second sample together: a play ball thrown on a round floor, after the BALL of GFW06.
#pragma once

#include "assets/glb_writer.h"

namespace mdk {

/// Ball and floor as two nodes, the ball squashed and sheared by nested scales; clips "throw" and
/// "bounce".
GlbScene make_ball_scene();

}  // namespace mdk
