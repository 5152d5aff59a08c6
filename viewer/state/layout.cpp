#include "viewer/state/layout.h"

#include <algorithm>
#include <cmath>

#include "viewer/state/time_line_rows.h"

namespace mdk {
namespace {

constexpr float kSidePanelWidth = 360, kTimeLineHeight = 128;

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

}  // namespace mdk
