// The random hand: the same seed does the same, and it does everything a hand can.
#include "viewer/random_hand.h"

#include <gtest/gtest.h>

#include <map>

namespace mdk::test {
namespace {

const WidgetMap kWidgets = {{"play", {10, 700, 30, 20}}, {"picture", {0, 0, 900, 600}}};

TEST(RandomHand, DoesTheSameForTheSameSeedAndEndsAfterItsEvents) {
  RandomHand a(500, 7, {"file"}), b(500, 7, {"file"}), other(500, 8, {"file"});
  int events = 0, different = 0;
  while (!a.done()) {
    const PlayedEvent x = a.next(kWidgets, 1280, 800), y = b.next(kWidgets, 1280, 800);
    const PlayedEvent z = other.next(kWidgets, 1280, 800);
    EXPECT_EQ(x.kind, y.kind);
    EXPECT_EQ(x.x, y.x);
    EXPECT_EQ(x.key.character, y.key.character);
    different += x.kind != z.kind || x.x != z.x;
    ++events;
  }
  EXPECT_EQ(events, 500);
  EXPECT_GT(different, 100);
}

TEST(RandomHand, DoesEveryKindOfThing) {
  RandomHand hand(5000, 1, {"file"});
  std::map<PlayedKind, int> kinds;
  while (!hand.done()) ++kinds[hand.next(kWidgets, 1280, 800).kind];
  EXPECT_EQ(kinds.size(), 7u);
  for (const auto& [kind, count] : kinds) EXPECT_GT(count, 15) << static_cast<int>(kind);
}

TEST(RandomHand, DropsNothingWhereThereIsNothing) {
  RandomHand hand(5000, 1, {});
  while (!hand.done()) EXPECT_NE(hand.next({}, 100, 100).kind, PlayedKind::kDrop);
}

}  // namespace
}  // namespace mdk::test
