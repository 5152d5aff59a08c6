// FileMenu: a list of animations to open, and a line to type a path into.
#pragma once

#include "viewer/panel/style.h"
#include "viewer/panel/ui_result.h"
#include "viewer/state/layout.h"
#include "viewer/state/view_state.h"

namespace mdk {

/// Over the picture, where state.file_menu is there; what is chosen comes back in
/// result.open_paths.
void draw_file_menu(const Rect& picture, const Theme& theme, ViewState& state, UiResult& result);

}  // namespace mdk
