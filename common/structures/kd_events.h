// The sorted event lists of a kd-tree build (Wald and Havran 2006, §4.4): where boxes start and end
// along an axis. Sorted once; a split hands each child its part in order, so nothing is sorted
// twice.
//
//   axis ──────|────[=====|==]──────      a box that straddles the plane is clipped to both cells:
//      below:  |    [=====]               its events are clamped to the plane. All others of that
//      above:             [==]            cell are on the same side of it, so order is kept.
#pragma once

#include <cstdint>
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

/// Where a plane cuts one axis' events: [.., below_hi] and [above_lo, ..]. The infinite default
/// leaves positions alone: axes other than the plane's.
struct KdClamp {
  float below_hi = std::numeric_limits<float>::infinity();
  float above_lo = -std::numeric_limits<float>::infinity();
};

/// The lists of all cells that wait to be split, for one axis. The cell at work owns the top, from
/// `begin` to the end of the stack.
class KdEventStack {
 public:
  /// Starts with one list: the boxes that are not empty. Cost: O(N log N).
  KdEventStack(std::span<const Aabb> boxes, int axis);

  std::span<const KdEvent> top(std::size_t begin) const {
    return std::span(events_).subspan(begin);
  }

  /// Replaces the top list by the part above, then the part below on top of it. `sides` is indexed
  /// by item. Returns where the part below begins; the part above begins at `begin`. Cost: O(list).
  std::size_t split(std::size_t begin, std::span<const KdSides> sides, const KdClamp& clamp);

  /// Drops the top list.
  void pop(std::size_t begin) { events_.resize(begin); }

 private:
  std::vector<KdEvent> events_;
  std::vector<KdEvent> below_;  ///< room to work in
};

}  // namespace mdk
