#include "viewer/state/layout.h"

#include <algorithm>
#include <cmath>

namespace mdk {
namespace {

// On an ordinary display.
constexpr float kSidePanelWidth = 360, kTimeLineHeight = 128;
constexpr float kTimeLineRowWidth = 740;  // of all controls
constexpr float kTimeLineRowHeight = 31;  // of a second row, with the gap above it

}  // namespace

Layout make_layout(float width, float height, float scale, PanelMode mode) {
  if (mode == PanelMode::kHidden) return {{0, 0, width, height}, {}, {}};
  const float side = std::floor(std::min(kSidePanelWidth * scale, width / 2));
  const float picture_width = width - side;
  const float time_line =
      kTimeLineHeight + (time_line_wraps(picture_width, scale) ? kTimeLineRowHeight : 0);
  const float below = std::floor(std::min(time_line * scale, height / 2));
  const float picture_height = height - below;
  return {{0, 0, picture_width, picture_height},
          {0, picture_height, picture_width, below},
          {picture_width, 0, side, height}};
}

bool time_line_wraps(float width, float scale) { return width < kTimeLineRowWidth * scale; }

std::vector<Rect> picture_places(const Rect& space, CompareMode mode) {
  if (mode != CompareMode::kSideBySide) return {space};
  const float half = space.width / 2;
  return {{space.x, space.y, half, space.height}, {space.x + half, space.y, half, space.height}};
}

}  // namespace mdk
