#include "viewer/random_hand.h"

#include <array>
#include <iterator>
#include <string_view>

// GLFW only for the names of keys.
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace mdk {
namespace {

constexpr std::array kKeys = {GLFW_KEY_SPACE,     GLFW_KEY_LEFT,  GLFW_KEY_RIGHT, GLFW_KEY_UP,
                              GLFW_KEY_DOWN,      GLFW_KEY_HOME,  GLFW_KEY_END,   GLFW_KEY_TAB,
                              GLFW_KEY_ESCAPE,    GLFW_KEY_ENTER, GLFW_KEY_F1,    GLFW_KEY_DELETE,
                              GLFW_KEY_BACKSPACE, GLFW_KEY_1,     GLFW_KEY_4,     GLFW_KEY_9};
constexpr std::string_view kCharacters =
    "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789.-+[]?/~ ";

}  // namespace

RandomHand::RandomHand(std::uint64_t events, std::uint64_t seed, std::vector<std::string> drops)
    : left_(events), random_(seed), drops_(std::move(drops)) {}

// The library's distributions differ from one library to the next; a seed shall not.
double RandomHand::uniform(double least, double most) {
  return least + (most - least) * static_cast<double>(random_() >> 11) * 0x1p-53;
}

std::size_t RandomHand::index(std::size_t count) {
  return static_cast<std::size_t>(uniform(0, static_cast<double>(count)));
}

PlayedEvent RandomHand::move(const WidgetMap& widgets, float width, float height) {
  PlayedEvent event;
  Rect place{-5, -5, width + 10, height + 10};
  if (!widgets.empty() && index(5) > 0) {
    auto widget = widgets.begin();
    std::advance(widget, static_cast<std::ptrdiff_t>(index(widgets.size())));
    place = widget->second;
  }
  event.x = place.x + static_cast<float>(uniform(0, static_cast<double>(place.width)));
  event.y = place.y + static_cast<float>(uniform(0, static_cast<double>(place.height)));
  return event;
}

PlayedEvent RandomHand::key() {
  PlayedEvent event;
  event.kind = PlayedKind::kKey;
  if (index(2) == 0)
    event.key.key = kKeys[index(kKeys.size())];
  else
    event.key.character = static_cast<unsigned>(kCharacters[index(kCharacters.size())]);
  return event;
}

PlayedEvent RandomHand::next(const WidgetMap& widgets, float width, float height) {
  --left_;
  const double what = uniform(0, 100);
  if (what < 38) return move(widgets, width, height);
  PlayedEvent event;
  if (what < 68) {
    event.kind = what < 53 ? PlayedKind::kPress : PlayedKind::kRelease;
    event.number = index(4) == 0 ? static_cast<int>(index(3)) : 0;
  } else if (what < 76) {
    event.kind = PlayedKind::kWheel;
    event.y = static_cast<float>(uniform(-4, 4));
  } else if (what < 98 || (what >= 99.3 && drops_.empty())) {
    return key();
  } else if (what < 99.3) {
    event.kind = PlayedKind::kResize;
    event.x = static_cast<float>(uniform(64, 1280));
    event.y = static_cast<float>(uniform(64, 800));
  } else {
    event.kind = PlayedKind::kDrop;
    event.path = drops_[index(drops_.size())];
  }
  return event;
}

}  // namespace mdk
