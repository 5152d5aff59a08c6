// Whether the time line's controls stand in one row or, where that would cut them off, in two.
#pragma once

namespace mdk {

inline constexpr float kTimeLineRowWidth = 740;  ///< of all controls, on an ordinary display
inline constexpr float kTimeLineRowHeight = 31;  ///< of a second row, with the gap above it

/// `scale`: 1 on an ordinary display.
inline bool time_line_wraps(float width, float scale) { return width < kTimeLineRowWidth * scale; }

}  // namespace mdk
