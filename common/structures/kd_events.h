// The sorted event lists of a kd-tree build (Wald and Havran 2006, §4.4): where boxes start and end
// along an axis. Sorted once; a split hands each child its part in order, so nothing is sorted
// twice.
//
//   axis ──────|────[=====|==]──────      a box that straddles the plane is clipped to both cells:
//      below:  |    [=====]               its events are clamped to the plane. All others of that
//      above:             [==]            cell are on the same side of it, so order is kept.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "common/math/aabb.h"

namespace mdk {

/// One end of a box along one axis, or both at once where the box is flat. 8 bytes.
class KdEvent {
 public:
  enum Type : std::uint32_t { kEnd, kPlanar, kStart };
  /// Items are counted in 30 bits.
  static constexpr std::uint32_t kMaxItems = 1u << 30;

  KdEvent() = default;
  KdEvent(float at, Type type, std::uint32_t item) : position(at), tag_(item << 2 | type) {}

  Type type() const { return static_cast<Type>(tag_ & 3u); }
  std::uint32_t item() const { return tag_ >> 2; }
  /// Total order, by position first: what follows from a sorted list depends on the input alone.
  bool operator<(const KdEvent& b) const {
    return position < b.position || (position == b.position && tag_ < b.tag_);
  }

  float position = 0;

 private:
  std::uint32_t tag_ = 0;
};

/// Which children of a cell an item goes to. Bits, so that a list can be filtered without branches.
enum KdSides : std::uint8_t { kBelow = 1, kAbove = 2, kBoth = 3 };

/// The lists of all cells that wait to be split, for one axis. The cell at work owns the top, from
/// `begin` to the end of the stack.
class KdEventStack {
 public:
  /// Starts with one list: the boxes that are not empty. Cost: O(N log N).
  KdEventStack(std::span<const Aabb> boxes, std::size_t axis) {
    events_.reserve(2 * boxes.size());
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      if (boxes[i].empty()) continue;
      const auto item = static_cast<std::uint32_t>(i);
      const float lo = boxes[i].lo[axis], hi = boxes[i].hi[axis];
      if (lo == hi) {
        events_.emplace_back(lo, KdEvent::kPlanar, item);
      } else {
        events_.emplace_back(lo, KdEvent::kStart, item);
        events_.emplace_back(hi, KdEvent::kEnd, item);
      }
    }
    std::sort(events_.begin(), events_.end());
  }

  std::span<const KdEvent> top(std::size_t begin) const {
    return std::span(events_).subspan(begin);
  }

  /// Replaces the top list by the part above, then the part below on top of it. `sides` is indexed
  /// by item. Boxes are cut off at the plane between the parts, on its own axis. Returns where the
  /// part below begins; the part above begins at `begin`. Cost: O(list).
  std::size_t split_at(float plane, std::size_t begin, std::span<const KdSides> sides) {
    return split(begin, sides, plane, plane);
  }
  /// The same for the other axes: no box is cut off.
  std::size_t split_across(std::size_t begin, std::span<const KdSides> sides) {
    constexpr float kInf = std::numeric_limits<float>::infinity();
    return split(begin, sides, kInf, -kInf);
  }

  /// Drops the top list.
  void pop(std::size_t begin) { events_.resize(begin); }

 private:
  std::size_t split(std::size_t begin, std::span<const KdSides> sides, float below_hi,
                    float above_lo) {
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
      below[below_count].position = std::min(event.position, below_hi);
      below_count += side & kBelow;
      list[above_count] = event;
      list[above_count].position = std::max(event.position, above_lo);
      above_count += (side & kAbove) >> 1;
    }
    events_.resize(begin + above_count);
    events_.insert(events_.end(), below, below + below_count);
    return begin + above_count;
  }

  std::vector<KdEvent> events_;
  std::vector<KdEvent> below_;  ///< room to work in
};

}  // namespace mdk
