// Line charts as SVG, one by one or several as a figure. Colours are classes (chart_style), so that
// one chart serves light and dark, and a series looks the same in every chart of a page.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace mdk {

enum class Scale { kLinear, kLog };

/// Where a linear axis ends.
enum class AxisEnd {
  kAtTick,  ///< at the first tick past the values
  kAtData,  ///< at the largest value; ticks are whole numbers: keys, clusters, per cent
};

/// One axis: which values it spans, where they lie, and the ticks that people read. Maps values to
/// [0, 1]. A linear axis starts at 0; a logarithmic one spans the values and takes what is below
/// its lowest for the lowest.
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

struct ChartPoint {
  double x = 0, y = 0;
};

struct ChartSeries {
  std::string label;
  std::string style;  ///< class from technique_style() or numbered_style()
  std::vector<ChartPoint> points;
};

enum class Labels {
  kNone,   ///< a legend elsewhere names the series
  kAtEnd,  ///< each series is named at its last point: for a few
};
enum class Marks { kNone, kDots };

struct Chart {
  std::string title;
  std::string x_label, y_label;  ///< with units
  Scale x_scale = Scale::kLinear, y_scale = Scale::kLinear;
  Labels labels = Labels::kNone;
  Marks marks = Marks::kNone;
  std::vector<ChartSeries> series = {};
};

/// Units of the drawing, which are pixels where it is shown at its natural size.
struct ChartSize {
  double width = 430, height = 260;
};

/// One <svg> element. Points that are not finite, or not positive on a logarithmic axis, are left
/// out.
std::string chart_svg(const Chart& chart, const ChartSize& size);

/// Charts that share a legend, where they have one.
struct Figure {
  std::string id;  ///< for file names and links
  std::string caption;
  std::vector<Chart> charts = {};
  bool has_legend = true;

  bool is_wide() const { return charts.size() < 3; }
  ChartSize chart_size() const { return is_wide() ? ChartSize{560, 320} : ChartSize{}; }
  /// The label and style of every series, once each, in order of appearance.
  std::vector<std::pair<std::string, std::string>> legend() const;
};

/// A picture of its own: the figure's legend and charts, in light or dark colours.
std::string figure_svg(const Figure& figure);

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
