#include "viewer/state/compare.h"

#include <array>
#include <string>

#include "common/base/error.h"
#include "common/trace/technique.h"

namespace mdk {
namespace {

struct Row {
  CompareMode mode;
  std::string_view id;
};
constexpr std::array kModes = {Row{CompareMode::kOff, "off"}, Row{CompareMode::kSideBySide, "side"},
                               Row{CompareMode::kWipe, "wipe"},
                               Row{CompareMode::kDifference, "difference"}};

}  // namespace

std::string_view compare_mode_id(CompareMode mode) {
  for (const Row& row : kModes)
    if (row.mode == mode) return row.id;
  return {};
}

CompareMode find_compare_mode(std::string_view id) {
  for (const Row& row : kModes)
    if (row.id == id) return row.mode;
  throw Error(ErrorCode::kUsage,
              "--compare \"" + std::string(id) + "\": give off, side, wipe or difference");
}

CompareMode next_compare_mode(CompareMode mode) {
  return static_cast<CompareMode>((static_cast<std::size_t>(mode) + 1) % kModes.size());
}

std::vector<Rect> picture_places(const Rect& room, CompareMode mode) {
  if (mode != CompareMode::kSideBySide) return {room};
  const float half = room.width / 2;
  return {{room.x, room.y, half, room.height}, {room.x + half, room.y, half, room.height}};
}

std::size_t default_against() {
  return static_cast<std::size_t>(&find_technique("rebuild-bvh") - technique_table().data());
}

}  // namespace mdk
