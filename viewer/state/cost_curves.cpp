#include "viewer/state/cost_curves.h"

#include <algorithm>

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

}  // namespace

void CostCurves::start(const std::vector<double>& key_times) {
  curves_.clear();
  moments_.clear();
  const std::size_t count = std::min(key_times.size(), kMostMoments);
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
