// PosePanel: over the picture of a file that can be posed by hand, its joints and their turns.
#pragma once

#include "viewer/panel/style.h"
#include "viewer/panel/ui_result.h"
#include "viewer/state/view_state.h"

namespace mdk {

/// Draws nothing where the model has no skeleton.
void draw_pose_panel(const Rect& picture, const Theme& theme, ViewState& state, UiResult& result);

}  // namespace mdk
