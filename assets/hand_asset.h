// Puts the sample hand together: shape, mesh, skin, colours and clips.
#pragma once

#include "assets/glb_writer.h"

namespace mdk {

/// The whole hand, ready to be written. Takes a few seconds.
GlbScene make_hand_scene();

}  // namespace mdk
