#include "preprocess/bench/chart.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <span>

#include "common/base/text.h"

namespace mdk {
namespace {

// --- axes ---

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

// --- one chart ---

constexpr double kLeft = 50, kRight = 14, kTop = 40, kBottom = 40;
constexpr double kLabelHeight = 14;  // of a series' name at its end
constexpr double kLetterWidth = 6.7;

std::string number(double value) { return fixed_text(value, 1); }

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

  std::string grid() const {
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
    svg +=
        text_element((kLeft + right_) / 2, bottom_ + 33, "text-anchor=\"middle\"", chart_.x_label);
    svg += text_element(8, 30, "", chart_.y_label);
    return svg;
  }

  std::string lines() const {
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
  std::string names() const {
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

 private:
  static double name_room(const Chart& chart) {
    if (chart.labels == Labels::kNone) return 0;
    std::size_t longest = 0;
    for (const ChartSeries& series : chart.series) longest = std::max(longest, series.label.size());
    return 6 + kLetterWidth * static_cast<double>(longest);
  }
  double x(double value) const { return kLeft + x_.place(value) * (right_ - kLeft); }
  double y(double value) const { return bottom_ - y_.place(value) * (bottom_ - kTop); }
  std::vector<ChartPoint> drawn(const ChartSeries& series) const {
    std::vector<ChartPoint> points;
    for (const ChartPoint& p : series.points)
      if (can_show(chart_, p)) points.push_back({x(p.x), y(p.y)});
    return points;
  }

  const Chart& chart_;
  Axis x_, y_;
  double right_, bottom_;
};

// --- figures ---

constexpr double kLegendRow = 20, kLegendEntry = 200, kGap = 8, kMargin = 12;

std::string placed(double x, double y, const std::string& svg) {
  return "<g transform=\"translate(" + std::to_string(static_cast<int>(x)) + " " +
         std::to_string(static_cast<int>(y)) + ")\">" + svg + "</g>\n";
}

// --- colours ---

/// Techniques of one family share a hue and differ by their dashes, so that thirteen lines stay
/// apart, for colour-blind eyes too (hues after Okabe and Ito).
struct SeriesColor {
  std::string_view style;
  std::string_view light, dark;
  std::string_view line;  ///< further properties of the line
};

constexpr SeriesColor kColors[] = {
    {"fuzzy-bvh", "#0059b8", "#6db3ff", "stroke-width:2.8"},
    {"fuzzy-kdtree", "#2a95d6", "#9ad4f7", "stroke-width:2.2;stroke-dasharray:7 2"},
    {"static-kdtree", "#7a6a00", "#e3d35c", ""},
    {"rebuild-bvh", "#c23b0a", "#ff8a5c", ""},
    {"refit-bvh", "#d98200", "#ffb84d", ""},
    {"tsah-refit", "#d98200", "#ffb84d", "stroke-dasharray:6 3"},
    {"hybrid-bvh", "#d98200", "#ffb84d", "stroke-dasharray:2 2.5"},
    {"rotate-bvh", "#d98200", "#ffb84d", "stroke-dasharray:8 2 2 2"},
    {"decomp-refit", "#00805e", "#3fd0a5", ""},
    {"auto", "#a8428a", "#f09ad4", "stroke-dasharray:8 2 2 2"},
    {"embree", "#4d545c", "#b8c0c8", "stroke-width:2.2"},
    {"embree-refit", "#4d545c", "#b8c0c8", "stroke-dasharray:6 3"},
    {"embree-low", "#4d545c", "#b8c0c8", "stroke-dasharray:2 2.5"},
    {"embree-medium", "#4d545c", "#b8c0c8", "stroke-dasharray:8 2 2 2"},
    {"brute-force", "#000000", "#ffffff", "stroke-dasharray:1 3"},
    {"n0", "#0059b8", "#6db3ff", ""},
    {"n1", "#c23b0a", "#ff8a5c", ""},
    {"n2", "#00805e", "#3fd0a5", ""},
    {"n3", "#d98200", "#ffb84d", ""},
    {"n4", "#a8428a", "#f09ad4", ""},
    {"n5", "#2a95d6", "#9ad4f7", ""},
    {"n6", "#7a6a00", "#e3d35c", ""},
    {"n7", "#4d545c", "#b8c0c8", ""},
    {"n8", "#0059b8", "#6db3ff", "stroke-dasharray:6 3"},
    {"n9", "#c23b0a", "#ff8a5c", "stroke-dasharray:6 3"},
    {"n10", "#00805e", "#3fd0a5", "stroke-dasharray:6 3"},
    {"n11", "#d98200", "#ffb84d", "stroke-dasharray:6 3"},
};
constexpr std::size_t kNumbered = 12;

/// Ground, ink and lines that are no data.
constexpr SeriesColor kPlain[] = {{"chart-ground", "#ffffff", "#14181d", ""},
                                  {"chart-ink", "#20262d", "#e3e8ee", ""},
                                  {"chart-faint", "#5a6470", "#9aa5b1", ""},
                                  {"chart-grid", "#e3e7eb", "#2b323a", ""},
                                  {"chart-axis", "#aab2bb", "#4c5662", ""}};

/// `shade`: SeriesColor::light or ::dark.
std::string color_variables(std::string_view SeriesColor::*shade) {
  std::string css;
  for (const std::span<const SeriesColor> colors :
       {std::span<const SeriesColor>(kPlain), std::span<const SeriesColor>(kColors)})
    for (const SeriesColor& color : colors)
      css.append("--").append(color.style).append(":").append(color.*shade).append(";");
  return css;
}

constexpr std::string_view kChartRules =
    ".chart text{font:12px system-ui,-apple-system,'Segoe UI',Roboto,sans-serif;"
    "fill:var(--chart-faint)}\n"
    ".chart .title{font-weight:600;fill:var(--chart-ink)}\n"
    ".chart .grid{stroke:var(--chart-grid);fill:none}\n"
    ".chart .axis{stroke:var(--chart-axis);fill:none}\n"
    ".line{fill:none;stroke-width:1.7;stroke-linejoin:round;stroke-linecap:butt}\n"
    ".dot{stroke:none}\n"
    ".chart .name{font-weight:600}\n";

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

std::string escaped(std::string_view text) {
  static constexpr std::pair<char, const char*> kNames[] = {
      {'&', "&amp;"}, {'<', "&lt;"}, {'>', "&gt;"}, {'"', "&quot;"}};
  std::string safe;
  for (const char c : text) {
    const auto named = std::find_if(std::begin(kNames), std::end(kNames),
                                    [&](const auto& name) { return name.first == c; });
    if (named != std::end(kNames)) {
      safe += named->second;
    } else if (static_cast<unsigned char>(c) >= 0x20 || c == '\n' || c == '\t') {
      safe += c;
    }
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

std::vector<std::pair<std::string, std::string>> Figure::legend() const {
  std::vector<std::pair<std::string, std::string>> entries;
  for (const Chart& chart : charts)
    for (const ChartSeries& line : chart.series) {
      std::pair<std::string, std::string> entry{line.label, line.style};
      if (std::find(entries.begin(), entries.end(), entry) == entries.end())
        entries.push_back(std::move(entry));
    }
  return entries;
}

std::string figure_svg(const Figure& figure) {
  const ChartSize size = figure.chart_size();
  const std::size_t columns = std::min<std::size_t>(figure.charts.size(), 2);
  const double width = static_cast<double>(columns) * (size.width + kGap) - kGap + 2 * kMargin;
  const auto per_row =
      std::max<std::size_t>(1, static_cast<std::size_t>((width - 2 * kMargin) / kLegendEntry));
  std::string body;
  double y = kMargin;
  if (figure.has_legend) {
    const auto legend = figure.legend();
    for (std::size_t i = 0; i < legend.size(); ++i)
      body += placed(kMargin + static_cast<double>(i % per_row) * kLegendEntry,
                     y + static_cast<double>(i / per_row) * kLegendRow,
                     "<path class=\"line " + legend[i].second +
                         "\" d=\"M1 8H27\"/><text x=\"34\" y=\"12\">" + escaped(legend[i].first) +
                         "</text>");
    y += static_cast<double>((legend.size() + per_row - 1) / per_row) * kLegendRow + kGap;
  }
  for (std::size_t i = 0; i < figure.charts.size(); ++i) {
    std::string chart = chart_svg(figure.charts[i], size);
    const std::string natural_size = " width=\"" + std::to_string(static_cast<int>(size.width)) +
                                     "\" height=\"" +
                                     std::to_string(static_cast<int>(size.height)) + "\"";
    chart.insert(std::string("<svg").size(), natural_size);
    body += placed(kMargin + static_cast<double>(i % columns) * (size.width + kGap), y, chart);
    if (i % columns + 1 == columns || i + 1 == figure.charts.size()) y += size.height + kGap;
  }
  const std::string box = std::to_string(static_cast<int>(width)) + " " +
                          std::to_string(static_cast<int>(y + kMargin - kGap));
  return "<svg class=\"chart\" xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + box +
         "\">\n<style>\n" + chart_style("svg") +
         "</style>\n<rect width=\"100%\" height=\"100%\" fill=\"var(--chart-ground)\"/>\n" + body +
         "</svg>\n";
}

std::string technique_style(std::string_view id) {
  for (const SeriesColor& color : kColors)
    if (color.style == id) return std::string(id);
  return "brute-force";
}

std::string numbered_style(std::size_t n) {
  return std::string("n").append(std::to_string(n % kNumbered));
}

std::string chart_style(std::string_view root) {
  const std::string selector(root);
  std::string css = selector + "{" + color_variables(&SeriesColor::light) + "}\n" +
                    "@media (prefers-color-scheme:dark){" + selector + "{" +
                    color_variables(&SeriesColor::dark) + "}}\n";
  css += kChartRules;
  for (const SeriesColor& color : kColors) {
    const std::string style(color.style), value = "var(--" + style + ")";
    css += ".line." + style + "{stroke:" + value + ";" + std::string(color.line) + "}";
    css += ".dot." + style + ",.chart .name." + style + "{fill:" + value + "}\n";
  }
  return css;
}

}  // namespace mdk
