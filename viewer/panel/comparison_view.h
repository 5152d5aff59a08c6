// ComparisonView: what stands over the pictures of two techniques: their names and times, and the
// divider of a wipe.
#pragma once

#include "viewer/panel/style.h"
#include "viewer/panel/ui_result.h"
#include "viewer/state/view_state.h"

namespace mdk {

/// Nothing where nothing is compared. The divider follows the hand at once.
void draw_comparison(const Rect& picture, const Theme& theme, ViewState& state, UiResult& result);

/// "0 of 651,360 pixels differ"
std::string difference_text(const PictureDifference& difference, const FrameReport& frame);

}  // namespace mdk
