// Sorting events once, and filtering them in order at every split.
#include "common/structures/kd_events.h"

#include <algorithm>

namespace mdk {

KdEventStack::KdEventStack(std::span<const Aabb> boxes, int axis) {
  const auto a = static_cast<std::size_t>(axis);
  events_.reserve(2 * boxes.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (boxes[i].empty()) continue;
    const auto item = static_cast<std::uint32_t>(i);
    const float lo = boxes[i].lo[a], hi = boxes[i].hi[a];
    if (lo == hi) {
      events_.emplace_back(lo, KdEvent::kPlanar, item);
    } else {
      events_.emplace_back(lo, KdEvent::kStart, item);
      events_.emplace_back(hi, KdEvent::kEnd, item);
    }
  }
  std::sort(events_.begin(), events_.end());
}

std::size_t KdEventStack::split(std::size_t begin, std::span<const KdSides> sides,
                                const KdClamp& clamp) {
  // Each event is written to both parts and kept where it belongs; the part above overwrites the
  // list it is read from, which it can never overtake.
  const std::size_t count = events_.size() - begin;
  if (below_.size() < count) below_.resize(count);
  KdEvent* const list = events_.data() + begin;
  KdEvent* const below = below_.data();
  std::size_t below_count = 0, above_count = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const KdEvent event = list[i];
    const KdSides side = sides[event.item()];
    below[below_count] = event;
    below[below_count].position = std::min(event.position, clamp.below_hi);
    below_count += side & kBelow;
    list[above_count] = event;
    list[above_count].position = std::max(event.position, clamp.above_lo);
    above_count += (side & kAbove) >> 1;
  }
  events_.resize(begin + above_count);
  events_.insert(events_.end(), below, below + below_count);
  return begin + above_count;
}

}  // namespace mdk
