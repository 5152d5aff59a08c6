// From what the user looks at to what the worker is asked for, and back.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "viewer/picture/render_worker.h"
#include "viewer/state/view_state.h"

namespace mdk {

/// The picture of an open file. A pose in which the boxes of all times do not hold is traced by a
/// technique that needs none.
RenderJob picture_job(const ViewState& state, std::uint32_t width, std::uint32_t height);

/// Notes in the state what a frame without error cost; true where it was timed, not counted.
bool note_costs(const FinishedFrame& frame, ViewState& state);

/// Row of technique_table(). Throws Error (kUsage) for an unknown id.
std::size_t technique_row(std::string_view id);

}  // namespace mdk
