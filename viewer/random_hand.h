// RandomHand: does to the viewer what nobody would think of, in an order that a seed fixes.
#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "viewer/state/widget_map.h"
#include "viewer/window/played_event.h"

namespace mdk {

class RandomHand {
 public:
  /// `events` in all. `drops`: files and folders it may drop on the window.
  RandomHand(std::uint64_t events, std::uint64_t seed, std::vector<std::string> drops);

  bool done() const { return left_ == 0; }
  /// Mostly at a widget, at times anywhere in the window or just outside. Call while not done().
  PlayedEvent next(const WidgetMap& widgets, float width, float height);

 private:
  double uniform(double least, double most);
  std::size_t index(std::size_t count);
  PlayedEvent move(const WidgetMap& widgets, float width, float height);
  PlayedEvent key();

  std::uint64_t left_;
  std::mt19937_64 random_;
  std::vector<std::string> drops_;
};

}  // namespace mdk
