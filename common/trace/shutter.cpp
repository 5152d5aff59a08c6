#include "common/trace/shutter.h"

#include <cmath>
#include <numbers>

namespace mdk {

std::vector<KeyInterval> shutter_moments(const Model& model, std::uint32_t clip, double seconds,
                                         double open, std::uint32_t samples) {
  std::vector<KeyInterval> moments;
  moments.reserve(samples);
  for (std::uint32_t i = 0; i < samples; ++i) {
    const double place = 0.5 + i / std::numbers::phi;
    moments.push_back(locate_time(model, clip, seconds + open * (place - std::floor(place) - 0.5)));
  }
  return moments;
}

}  // namespace mdk
