#include "viewer/state/frame_history.h"

#include <algorithm>
#include <vector>

namespace mdk {

void FrameHistory::add(const FrameSample& sample) {
  if (samples_.size() == kCapacity) samples_.pop_front();
  samples_.push_back(sample);
}

double FrameHistory::longest_ms() const {
  double longest = 0;
  for (const FrameSample& sample : samples_) longest = std::max(longest, sample.time_to_image_ms);
  return longest;
}

std::optional<double> FrameHistory::median_ms(std::size_t technique) const {
  std::vector<double> latest;
  for (auto it = samples_.rbegin(); it != samples_.rend() && latest.size() < kMedianOver; ++it)
    if (it->technique == technique) latest.push_back(it->time_to_image_ms);
  if (latest.empty()) return {};
  const auto middle = latest.begin() + static_cast<std::ptrdiff_t>(latest.size() / 2);
  std::nth_element(latest.begin(), middle, latest.end());
  return *middle;
}

}  // namespace mdk
