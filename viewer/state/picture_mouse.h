// What the mouse does over the picture: orbit, pan, zoom, pick.
#pragma once

#include "viewer/state/layout.h"
#include "viewer/state/orbit_camera.h"
#include "viewer/state/view_state.h"

namespace mdk {

/// Moves the camera by what the mouse has done since the last ImGui frame. Whether a hand holds it.
bool steer_by_mouse(OrbitCamera& camera, const Rect& picture);

/// A click that was no drag picks the triangle under it, or nothing over the background, and opens
/// the page that tells about it. Whether there was one.
bool pick_by_mouse(ViewState& state, const Rect& picture);

}  // namespace mdk
