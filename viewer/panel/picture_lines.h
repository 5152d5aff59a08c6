// PictureLines: boxes and bases drawn over the picture, as its camera sees them.
#pragma once

#include "viewer/panel/style.h"
#include "viewer/state/view_state.h"

namespace mdk {

/// What state.overlays, the pick and the hovered cluster ask for, for the moment of the last frame,
/// in the colours of the clusters. Lines behind the surface show as well. Cost: O(clusters), at
/// most kMostTreeCells cells; O(vertices + triangles) for a pose by hand.
void draw_picture_lines(const Rect& picture, const Theme& theme, const ViewState& state);

inline constexpr std::size_t kMostTreeCells = 4000;

}  // namespace mdk
