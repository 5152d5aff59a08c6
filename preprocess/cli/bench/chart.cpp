#include "preprocess/cli/bench/chart.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace mdk {
namespace {

constexpr double kLeft = 50, kRight = 14, kTop = 40, kBottom = 40;
constexpr double kLabelHeight = 14;  // of a series' name at its end
constexpr double kLetterWidth = 6.7;

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f", value);
  return text;
}

std::string text_element(double x, double y, const std::string& attributes, std::string_view text) {
  return "<text x=\"" + number(x) + "\" y=\"" + number(y) + "\" " + attributes + ">" +
         escaped(text) + "</text>\n";
}

std::vector<double> values_of(const Chart& chart, double ChartPoint::*coordinate) {
  std::vector<double> values;
  for (const ChartSeries& series : chart.series)
    for (const ChartPoint& point : series.points) values.push_back(point.*coordinate);
  return values;
}

bool can_show(const Chart& chart, const ChartPoint& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && (chart.x_scale == Scale::kLinear || p.x > 0) &&
         (chart.y_scale == Scale::kLinear || p.y > 0);
}

/// Where the data lie within the drawing.
class Plot {
 public:
  Plot(const Chart& chart, const ChartSize& size)
      : chart_(chart),
        x_(chart.x_scale, AxisEnd::kAtData, values_of(chart, &ChartPoint::x)),
        y_(chart.y_scale, AxisEnd::kAtTick, values_of(chart, &ChartPoint::y)),
        right_(size.width - kRight - name_room(chart)),
        bottom_(size.height - kBottom) {}

  std::string grid() const;
  std::string lines() const;
  std::string names() const;

 private:
  static double name_room(const Chart& chart) {
    if (chart.labels == Labels::kNone) return 0;
    std::size_t longest = 0;
    for (const ChartSeries& series : chart.series) longest = std::max(longest, series.label.size());
    return 6 + kLetterWidth * static_cast<double>(longest);
  }
  double x(double value) const { return kLeft + x_.place(value) * (right_ - kLeft); }
  double y(double value) const { return bottom_ - y_.place(value) * (bottom_ - kTop); }
  std::vector<ChartPoint> drawn(const ChartSeries& series) const;

  const Chart& chart_;
  Axis x_, y_;
  double right_, bottom_;
};

std::string Plot::grid() const {
  std::string svg;
  for (const double tick : y_.ticks()) {
    svg += "<path class=\"grid\" d=\"M" + number(kLeft) + " " + number(y(tick)) + "H" +
           number(right_) + "\"/>\n";
    svg += text_element(kLeft - 6, y(tick) + 4, "text-anchor=\"end\"", tick_text(tick));
  }
  for (const double tick : x_.ticks()) {
    svg += "<path class=\"axis\" d=\"M" + number(x(tick)) + " " + number(bottom_) + "v4\"/>\n";
    svg += text_element(x(tick), bottom_ + 17, "text-anchor=\"middle\"", tick_text(tick));
  }
  svg += "<path class=\"axis\" d=\"M" + number(kLeft) + " " + number(bottom_) + "H" +
         number(right_) + "\"/>\n";
  svg += text_element((kLeft + right_) / 2, bottom_ + 33, "text-anchor=\"middle\"", chart_.x_label);
  svg += text_element(8, 30, "", chart_.y_label);
  return svg;
}

std::vector<ChartPoint> Plot::drawn(const ChartSeries& series) const {
  std::vector<ChartPoint> points;
  for (const ChartPoint& p : series.points)
    if (can_show(chart_, p)) points.push_back({x(p.x), y(p.y)});
  return points;
}

std::string Plot::lines() const {
  std::string svg;
  for (auto series = chart_.series.rbegin(); series != chart_.series.rend(); ++series) {
    const std::vector<ChartPoint> points = drawn(*series);  // the first one ends on top
    std::string path, dots;
    for (const ChartPoint& p : points) {
      path.append(path.empty() ? "M" : "L").append(number(p.x) + " " + number(p.y));
      if (chart_.marks == Marks::kDots || points.size() == 1)
        dots += "<circle class=\"dot " + series->style + "\" cx=\"" + number(p.x) + "\" cy=\"" +
                number(p.y) + "\" r=\"3\"/>\n";
    }
    if (points.empty()) continue;
    svg += "<path class=\"line " + series->style + "\" d=\"" + path + "\"><title>" +
           escaped(series->label) + "</title></path>\n" + dots;
  }
  return svg;
}

/// Names at the ends of the series, moved apart where they would overlap.
std::string Plot::names() const {
  struct Name {
    double y;
    const ChartSeries* series;
  };
  std::vector<Name> names;
  for (const ChartSeries& series : chart_.series) {
    const std::vector<ChartPoint> points = drawn(series);
    if (!points.empty()) names.push_back({points.back().y, &series});
  }
  std::stable_sort(names.begin(), names.end(),
                   [](const Name& a, const Name& b) { return a.y < b.y; });
  for (std::size_t i = 1; i < names.size(); ++i)
    names[i].y = std::max(names[i].y, names[i - 1].y + kLabelHeight);
  double lowest = bottom_;
  for (std::size_t i = names.size(); i-- > 0;) {
    names[i].y = std::min(names[i].y, lowest);
    lowest = names[i].y - kLabelHeight;
  }
  std::string svg;
  for (const Name& name : names)
    svg += text_element(right_ + 6, name.y + 4, "class=\"name " + name.series->style + "\"",
                        name.series->label);
  return svg;
}

}  // namespace

std::string escaped(std::string_view text) {
  std::string safe;
  for (const char c : text) switch (c) {
      case '&':
        safe += "&amp;";
        break;
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      case '"':
        safe += "&quot;";
        break;
      default:
        if (static_cast<unsigned char>(c) >= 0x20 || c == '\n' || c == '\t') safe += c;
    }
  return safe;
}

std::string chart_svg(const Chart& chart, const ChartSize& size) {
  const Plot plot(chart, size);
  std::string svg = "<svg class=\"chart\" xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " +
                    number(size.width) + " " + number(size.height) +
                    "\" role=\"img\" aria-label=\"" + escaped(chart.title) + "\">\n";
  svg += text_element(8, 14, "class=\"title\"", chart.title);
  svg += plot.grid() + plot.lines();
  if (chart.labels == Labels::kAtEnd) svg += plot.names();
  return svg + "</svg>\n";
}

std::string swatch_svg(std::string_view style) {
  return "<svg class=\"swatch\" xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 28 10\" "
         "width=\"28\" height=\"10\" aria-hidden=\"true\"><path class=\"line " +
         std::string(style) + "\" d=\"M1 5H27\"/></svg>";
}

}  // namespace mdk
