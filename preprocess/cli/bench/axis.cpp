#include "preprocess/cli/bench/axis.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace mdk {
namespace {

constexpr double kTicksWanted = 5;

/// Where ticks stand within each decade: the fewer decades, the more.
std::vector<double> tick_steps(double decades) {
  if (decades < 0.9) return {1, 1.5, 2, 3, 5, 7};
  if (decades < 1.7) return {1, 2, 5};
  return {1};
}

/// The least of 1, 2, 5, 10, 20, ... times a power of ten that is not below `value`.
double round_up_to_tick(double value) {
  const double decade = std::pow(10.0, std::floor(std::log10(value)));
  for (const double step : {1.0, 2.0, 5.0})
    if (value <= step * decade * (1 + 1e-9)) return step * decade;
  return 10 * decade;
}

std::string shortest(double value, const char* unit) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g%s", value, unit);
  return text;
}

}  // namespace

Axis::Axis(Scale scale, AxisEnd end, const std::vector<double>& values) : scale_(scale) {
  double lowest = INFINITY, highest = -INFINITY;
  for (const double value : values) {
    if (!std::isfinite(value) || (scale == Scale::kLog && !(value > 0))) continue;
    lowest = std::min(lowest, value);
    highest = std::max(highest, value);
  }
  if (!(lowest <= highest)) lowest = highest = 1;
  if (scale == Scale::kLog) {
    span_log(lowest, highest);
  } else {
    span_linear(highest, end);
  }
}

void Axis::span_linear(double highest, AxisEnd end) {
  if (!(highest > 0)) highest = 1;
  double step = round_up_to_tick(highest / kTicksWanted);
  if (end == AxisEnd::kAtData) step = std::max(step, 1.0);
  const double count = std::ceil(highest / step - 1e-9);
  high_ = end == AxisEnd::kAtTick ? count * step : highest;
  for (double i = 0; i * step <= high_ * (1 + 1e-9); ++i) ticks_.push_back(i * step);
}

void Axis::span_log(double lowest, double highest) {
  double from = std::log10(lowest), to = std::log10(highest);
  const double margin = to > from ? 0.03 * (to - from) + 0.01 : 0.2;
  from -= margin;
  to += margin;
  low_ = from;
  high_ = to;
  for (double decade = std::floor(from); decade <= to; ++decade)
    for (const double step : tick_steps(to - from)) {
      const double place = decade + std::log10(step);
      if (place >= from && place <= to) ticks_.push_back(std::pow(10.0, decade) * step);
    }
}

double Axis::place(double value) const {
  if (scale_ == Scale::kLog) {
    const double log = value > 0 ? std::log10(value) : low_;
    return std::clamp((log - low_) / (high_ - low_), 0.0, 1.0);
  }
  return std::clamp((value - low_) / (high_ - low_), 0.0, 1.0);
}

std::string tick_text(double value) {
  if (value >= 1e6) return shortest(value / 1e6, "M");
  if (value >= 1e3) return shortest(value / 1e3, "k");
  return shortest(value, "");
}

}  // namespace mdk
