// Line charts as SVG. Colours are classes (chart_style), so that one chart serves light and dark,
// and a series looks the same in every chart of a page.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "preprocess/cli/bench/axis.h"

namespace mdk {

struct ChartPoint {
  double x = 0, y = 0;
};

struct ChartSeries {
  std::string label;
  std::string style;  ///< class from series_style()
  std::vector<ChartPoint> points;
};

enum class Labels {
  kNone,   ///< a legend elsewhere tells the series apart
  kAtEnd,  ///< each series is named at its last point: for a few
};
enum class Marks { kNone, kDots };

struct Chart {
  std::string title;
  std::string x_label, y_label;  ///< with units
  Scale x_scale = Scale::kLinear, y_scale = Scale::kLinear;
  Labels labels = Labels::kNone;
  Marks marks = Marks::kNone;
  std::vector<ChartSeries> series;
};

/// Units of the drawing, which are pixels where it is shown at its natural size.
struct ChartSize {
  double width = 430, height = 260;
};

/// One <svg> element. Points that are not finite, or not positive on a logarithmic axis, are left
/// out.
std::string chart_svg(const Chart& chart, const ChartSize& size);

/// A stretch of line as a legend shows it: one <svg> element of 28 x 10.
std::string swatch_svg(std::string_view style);

/// The class of a technique: the same in every chart.
std::string technique_style(std::string_view id);
/// The class of the n-th of several other things, models say.
std::string numbered_style(std::size_t n);

/// CSS for charts: `root` is the selector that carries the colours (":root" in a page, "svg" in a
/// picture of its own).
std::string chart_style(std::string_view root);

/// Text with &, <, > and quotes made safe for HTML and SVG.
std::string escaped(std::string_view text);

}  // namespace mdk
