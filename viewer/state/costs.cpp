#include "viewer/state/costs.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace mdk {
namespace {

// Ends first, then the middle of each gap: 0, 8, 4, 2, 6, 1, 3, 5, 7.
std::vector<std::size_t> coarse_to_fine(std::size_t count) {
  std::vector<std::size_t> order;
  std::size_t step = 1;
  while (step < count) step *= 2;
  for (std::size_t i = 0; i < count; i += step) order.push_back(i);
  for (; step > 1; step /= 2)
    for (std::size_t i = step / 2; i < count; i += step) order.push_back(i);
  return order;
}

void note(const FrameReport& frame, FrameCosts& costs) {
  costs.history.add({frame.technique, frame.stats.time_to_image_ms()});
  costs.by_technique[frame.technique].frame = frame;
}

}  // namespace

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

void FrameCosts::add(FrameReport frame) {
  note(frame, *this);
  last = std::move(frame);
  second.reset();
  difference.reset();
}

void FrameCosts::add_second(FrameReport frame, const PictureDifference& found) {
  note(frame, *this);
  second = std::move(frame);
  difference = found;
}

void FrameCosts::add_work(const WorkReport& work) {
  by_technique[work.technique].work = work;
  last_work = work;
}

void CostCurves::start(const std::vector<double>& key_times) {
  curves_.clear();
  moments_.clear();
  const std::size_t count = std::min(key_times.size(), kMaxMoments);
  for (std::size_t i = 0; i < count; ++i)
    moments_.push_back(key_times[count > 1 ? i * (key_times.size() - 1) / (count - 1) : 0]);
  order_ = coarse_to_fine(count);
}

std::span<const std::optional<double>> CostCurves::curve(std::size_t technique) const {
  if (technique >= curves_.size()) return {};
  return curves_[technique].ms;
}

std::optional<std::size_t> CostCurves::next_moment(std::size_t technique) const {
  if (order_.empty()) return {};
  const std::size_t measured = technique < curves_.size() ? curves_[technique].measured : 0;
  if (measured >= order_.size() * kPasses) return {};
  return order_[measured % order_.size()];
}

void CostCurves::add(std::size_t technique, std::size_t moment, double ms) {
  if (moment >= moments_.size()) return;
  if (technique >= curves_.size()) curves_.resize(technique + 1);
  Curve& curve = curves_[technique];
  curve.ms.resize(moments_.size());
  curve.ms[moment] = std::min(ms, curve.ms[moment].value_or(ms));
  ++curve.measured;
}

std::size_t CostCurves::known(std::size_t technique) const {
  const auto ms = curve(technique);
  return static_cast<std::size_t>(
      std::ranges::count_if(ms, [](const auto& each) { return each.has_value(); }));
}

double CostCurves::longest_ms(std::size_t technique) const {
  double longest = 0;
  for (const auto& ms : curve(technique)) longest = std::max(longest, ms.value_or(0));
  return longest;
}

}  // namespace mdk
