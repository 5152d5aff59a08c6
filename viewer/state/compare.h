// Compare: how a second technique's picture is held against the first.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "viewer/state/widget_map.h"

namespace mdk {

enum class CompareMode {
  kOff,
  kSideBySide,  ///< two pictures, each in half of the room
  kWipe,        ///< one picture, the first technique's to the left of a divider
  kDifference,  ///< pixels that are not the same
};

struct CompareSettings {
  CompareMode mode = CompareMode::kOff;
  std::size_t against = 0;  ///< row of technique_table()
  float divider = 0.5f;     ///< of a wipe: part of the picture's width
};

/// Where two pictures of one view are not the same.
struct PictureDifference {
  std::uint64_t pixels = 0;   ///< how many
  std::uint32_t largest = 0;  ///< of one colour channel, 0 to 255
};

/// As in --compare and --print-state. find_compare_mode() throws Error (kUsage).
std::string_view compare_mode_id(CompareMode mode);
CompareMode find_compare_mode(std::string_view id);
CompareMode next_compare_mode(CompareMode mode);

/// Where in the room for pictures each of them lies: two side by side, or one.
std::vector<Rect> picture_places(const Rect& room, CompareMode mode);

/// What a technique is compared with unless one is chosen.
std::size_t default_against();

}  // namespace mdk
