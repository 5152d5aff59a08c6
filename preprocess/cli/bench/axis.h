// One axis of a chart: which values it spans, where they lie, and the ticks that people read.
#pragma once

#include <string>
#include <vector>

namespace mdk {

enum class Scale { kLinear, kLog };

/// Where a linear axis ends.
enum class AxisEnd {
  kAtTick,  ///< at the first tick past the values
  kAtData,  ///< at the largest value; ticks are whole numbers: keys, clusters, per cent
};

/// Maps values to [0, 1]. A linear axis starts at 0; a logarithmic one spans the values and takes
/// what is below its lowest for the lowest.
class Axis {
 public:
  /// `values`: those to show; not finite or, on a logarithmic axis, not positive ones are left out.
  Axis(Scale scale, AxisEnd end, const std::vector<double>& values);

  double place(double value) const;
  const std::vector<double>& ticks() const { return ticks_; }  ///< rising

 private:
  void span_linear(double highest, AxisEnd end);
  void span_log(double lowest, double highest);

  Scale scale_;
  double low_ = 0, high_ = 1;
  std::vector<double> ticks_;
};

/// "0.05", "20", "5k", "1.5M".
std::string tick_text(double value);

}  // namespace mdk
