// Overlays: what may lie over the picture: the empty window's welcome, an error, a notice, the
// keys.
#pragma once

#include "viewer/panel/style.h"
#include "viewer/panel/ui_result.h"
#include "viewer/state/view_state.h"

namespace mdk {

/// Draws those that `state` calls for, inside `picture`.
void draw_overlays(const Rect& picture, const Theme& theme, ViewState& state, UiResult& result);

}  // namespace mdk
