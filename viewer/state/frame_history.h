// FrameHistory: how long the latest frames took and by which technique; oldest first, bounded.
#pragma once

#include <cstddef>
#include <deque>
#include <optional>

namespace mdk {

struct FrameSample {
  std::size_t technique = 0;  ///< row of technique_table()
  double time_to_image_ms = 0;
};

class FrameHistory {
 public:
  static constexpr std::size_t kCapacity = 160;
  static constexpr std::size_t kMedianOver = 15;

  void add(const FrameSample& sample);
  void clear() { samples_.clear(); }

  const std::deque<FrameSample>& samples() const { return samples_; }
  double longest_ms() const;

  /// Median over the technique's latest frames here (at most kMedianOver); empty where it has none.
  std::optional<double> median_ms(std::size_t technique) const;

 private:
  std::deque<FrameSample> samples_;
};

}  // namespace mdk
