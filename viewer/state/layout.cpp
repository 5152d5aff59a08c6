#include "viewer/state/layout.h"

#include <algorithm>
#include <cmath>

namespace mdk {
namespace {

constexpr float kSidePanelWidth = 360, kTimeLineHeight = 128;

}  // namespace

Layout make_layout(float width, float height, float scale, PanelMode mode) {
  if (mode == PanelMode::kHidden) return {{0, 0, width, height}, {}, {}};
  const float side = std::floor(std::min(kSidePanelWidth * scale, width / 2));
  const float below = std::floor(std::min(kTimeLineHeight * scale, height / 2));
  const float picture_width = width - side, picture_height = height - below;
  return {{0, 0, picture_width, picture_height},
          {0, picture_height, picture_width, below},
          {picture_width, 0, side, height}};
}

}  // namespace mdk
