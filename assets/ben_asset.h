// BEN: a runner in one skin, after the largest model of GFW06.
#pragma once

#include "assets/glb_writer.h"

namespace mdk {

/// About 78,000 triangles, 19 joints, one clip of 30 keys.
GlbScene make_ben_scene();

}  // namespace mdk
