#include "viewer/picture/resolution.h"

namespace mdk {
namespace {

constexpr double kFluentMs = 40;  // 25 pictures a second still follow the hand

}  // namespace

std::uint32_t picture_divisor(Resolution resolution, Motion motion, double full_ms) {
  switch (resolution) {
    case Resolution::kFull:
      return 1;
    case Resolution::kHalf:
      return 2;
    case Resolution::kQuarter:
      return 4;
    case Resolution::kAuto:
      break;
  }
  if (motion == Motion::kStill || full_ms <= kFluentMs) return 1;
  return full_ms <= 4 * kFluentMs ? 2 : 4;
}

}  // namespace mdk
