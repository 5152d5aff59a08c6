// Charts: where a frame's time went, how long the latest frames took by which technique, and what
// the colours of a heat map mean.
#pragma once

#include <array>
#include <cstddef>
#include <string>

#include "common/trace/heat_map.h"
#include "viewer/panel/style.h"
#include "viewer/panel/widgets.h"
#include "viewer/state/costs.h"

namespace mdk {

struct FrameTime {
  const char* name;
  double ms;
};

/// The stages of a frame, then all of them up to the image.
std::array<FrameTime, 5> frame_times(const FrameStats& stats);

/// A bar cut in proportion, and below it each stage's time.
void draw_stage_bar(const Theme& theme, const FrameStats& stats);

/// One column per frame in its technique's colour, the latest at the right. The last item is the
/// plot's area.
void draw_history_plot(const Theme& theme, const FrameHistory& history);

/// A strip of colours over the panel's width, from 0 to the top of the scale, and its unit.
void draw_heat_legend(const Theme& theme, const HeatScale& heat);

/// All techniques with their latest times. Returns the one that is chosen now; `chosen` is a row of
/// technique_table(). Rows are recorded as `prefix` and the technique's id.
std::size_t draw_technique_list(const Theme& theme, const FrameHistory& history, std::size_t chosen,
                                const char* prefix, UiResult& result);

/// A technique's label in its colour.
void draw_technique_name(std::size_t technique);

/// "0 of 651,360 pixels differ"
std::string difference_text(const PictureDifference& difference, const FrameReport& frame);

/// Green where nothing differs.
ImU32 difference_color(const PictureDifference& difference);

}  // namespace mdk
