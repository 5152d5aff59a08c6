// What the mouse does over the picture: orbit, pan, zoom.
#pragma once

#include "viewer/state/layout.h"
#include "viewer/state/orbit_camera.h"

namespace mdk {

/// Moves the camera by what the mouse has done since the last ImGui frame. Whether a hand holds it.
bool steer_by_mouse(OrbitCamera& camera, const Rect& picture);

}  // namespace mdk
