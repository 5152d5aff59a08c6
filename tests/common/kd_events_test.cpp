// KdEventStack: lists are sorted once and stay sorted, and hold exactly the clipped boxes of each
// side.
#include "common/structures/kd_events.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "tests/common/random_boxes.h"

namespace mdk {
namespace {

/// Each item's interval as its events say it; fails where the list is out of order.
std::map<std::uint32_t, std::pair<float, float>> intervals(std::span<const KdEvent> events) {
  std::map<std::uint32_t, std::pair<float, float>> found;
  for (std::size_t i = 0; i < events.size(); ++i) {
    const KdEvent& event = events[i];
    if (i > 0) {
      EXPECT_LE(events[i - 1].position, event.position);
    }
    if (event.type() == KdEvent::kEnd) {
      EXPECT_TRUE(found.contains(event.item())) << "an end before its start";
      found[event.item()].second = event.position;
    } else {
      EXPECT_FALSE(found.contains(event.item())) << "listed twice";
      found[event.item()] = {event.position, event.position};
    }
  }
  return found;
}

TEST(KdEvents, ListsEachBoxThatIsNotEmpty) {
  std::vector<Aabb> boxes = test::scattered_boxes(100, 1, 0.3f, 61);
  boxes[7] = Aabb{};
  boxes[8].hi.y = boxes[8].lo.y;
  const KdEventStack stack(boxes, 1);
  const auto found = intervals(stack.top(0));
  EXPECT_EQ(found.size(), 99u);
  EXPECT_FALSE(found.contains(7));
  EXPECT_EQ(stack.top(0).size(), 2u * 98u + 1u);
  for (const auto& [item, interval] : found)
    EXPECT_EQ(interval, std::pair(boxes[item].lo.y, boxes[item].hi.y));
}

TEST(KdEvents, SplitClipsStraddlersAndKeepsOrder) {
  const std::uint64_t seed = 62;
  test::Random random(seed);
  for (int round = 0; round < 100; ++round) {
    SCOPED_TRACE(testing::Message() << "seed " << seed << " round " << round);
    std::vector<Aabb> boxes;
    for (int i = 0; i < 50; ++i) {
      const auto at = static_cast<float>(random.below(12)),
                 size = static_cast<float>(random.below(6));
      boxes.push_back(test::box_at({at, 0, 0}, {size, 1, 1}));
    }
    const float plane = static_cast<float>(1 + random.below(15));
    std::vector<KdSides> sides;
    std::map<std::uint32_t, std::pair<float, float>> below, above;
    for (std::uint32_t i = 0; i < 50; ++i) {
      const float lo = boxes[i].lo.x, hi = boxes[i].hi.x;
      sides.push_back(hi <= plane ? kBelow : lo >= plane ? kAbove : kBoth);
      if (sides[i] & kBelow) below[i] = {lo, std::min(hi, plane)};
      if (sides[i] & kAbove) above[i] = {std::max(lo, plane), hi};
    }
    KdEventStack stack(boxes, 0);
    const std::size_t top = stack.split_at(plane, 0, sides);
    EXPECT_EQ(intervals(stack.top(top)), below);
    stack.pop(top);
    EXPECT_EQ(intervals(stack.top(0)), above);
  }
}

TEST(KdEvents, SplitAcrossAnotherAxisLeavesPositionsAlone) {
  const std::vector<Aabb> boxes = test::scattered_boxes(3, 1, 0.3f, 63);
  const std::vector<KdSides> sides{kBoth, kAbove, kBelow};
  KdEventStack stack(boxes, 2);
  const std::size_t top = stack.split_across(0, sides);
  const auto whole = [&](std::uint32_t i) { return std::pair(boxes[i].lo.z, boxes[i].hi.z); };
  EXPECT_EQ(intervals(stack.top(top)),
            (std::map<std::uint32_t, std::pair<float, float>>{{0, whole(0)}, {2, whole(2)}}));
  stack.pop(top);
  EXPECT_EQ(intervals(stack.top(0)),
            (std::map<std::uint32_t, std::pair<float, float>>{{0, whole(0)}, {1, whole(1)}}));
}

}  // namespace
}  // namespace mdk
