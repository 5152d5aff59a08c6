// Panel: all that is drawn with Dear ImGui, and what the mouse does over the picture. Choices act
// on the state at once; the rest is asked for in the result.
#pragma once

#include "viewer/panel/style.h"
#include "viewer/panel/widgets.h"
#include "viewer/state/view_state.h"

namespace mdk {

/// The file's name, one of the pages (tabs.h), and the last frame's time, which is in sight
/// whichever page is open. A page that is higher than its space scrolls.
void draw_side_panel(const Rect& place, const Theme& theme, ViewState& state, UiResult& result);

/// The bar below the picture: play, step, loop, speed, clip, and the keys to scrub along.
void draw_time_line(const Rect& place, const Theme& theme, ViewState& state, UiResult& result);

/// What may lie over the picture: the empty window's welcome, a bake, an error, a notice, the file
/// menu (what is chosen there comes back in result.open_paths), the keys.
void draw_overlays(const Rect& picture, const Theme& theme, ViewState& state, UiResult& result);

/// The joints of a skeleton that can be posed by hand, and their turns. Nothing for other models.
void draw_pose_panel(const Rect& picture, const Theme& theme, ViewState& state, UiResult& result);

/// Over the pictures of two techniques: their names and times, and the divider of a wipe, which
/// follows the mouse at once. Nothing where nothing is compared.
void draw_comparison(const Rect& picture, const Theme& theme, ViewState& state, UiResult& result);

/// What state.overlays, the pick and the hovered cluster ask for, for the moment of the last frame,
/// in the colours of the clusters. Lines behind the surface show as well. Cost: O(clusters), at
/// most 4000 cells of a tree; O(vertices + triangles) for a pose by hand.
void draw_picture_lines(const Rect& picture, const Theme& theme, const ViewState& state);

/// Orbits, pans and zooms by what the mouse has done since the last ImGui frame. Whether a button
/// is held for that.
bool steer_by_mouse(OrbitCamera& camera, const Rect& picture);

/// A click that was no drag picks the triangle under it, or nothing over the background, and opens
/// the page that tells about it. Whether there was one.
bool pick_by_mouse(ViewState& state, const Rect& picture);

}  // namespace mdk
