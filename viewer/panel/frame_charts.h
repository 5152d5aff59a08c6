// FrameCharts: where a frame's time went, and how long the latest frames took.
#pragma once

#include <span>

#include "viewer/panel/style.h"
#include "viewer/state/frame_history.h"

namespace mdk {

struct FrameStage {
  const char* name;
  double ms;
};

/// A bar cut in proportion, and below it each stage's time.
void draw_stage_bar(const Theme& theme, std::span<const FrameStage> stages);

/// One column per frame in its technique's colour, the latest at the right. The last item is the
/// plot's area.
void draw_history_plot(const Theme& theme, const FrameHistory& history);

}  // namespace mdk
