// TechniqueList: all techniques with their latest times, one of them chosen.
#pragma once

#include <cstddef>

#include "viewer/panel/style.h"
#include "viewer/panel/ui_result.h"
#include "viewer/state/frame_history.h"

namespace mdk {

/// The one that is to be chosen now; `chosen` is a row of technique_table(). Rows are recorded as
/// `prefix` and the technique's id.
std::size_t draw_technique_list(const Theme& theme, const FrameHistory& history, std::size_t chosen,
                                const char* prefix, UiResult& result);

}  // namespace mdk
