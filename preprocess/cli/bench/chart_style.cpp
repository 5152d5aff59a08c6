// Colours of charts. Techniques of one family share a hue and differ by their dashes, so that
// thirteen lines stay apart, for colour-blind eyes too (hues after Okabe and Ito).
#include "preprocess/cli/bench/chart.h"

namespace mdk {
namespace {

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
struct PlainColor {
  std::string_view name, light, dark;
};
constexpr PlainColor kPlain[] = {{"chart-ground", "#ffffff", "#14181d"},
                                 {"chart-ink", "#20262d", "#e3e8ee"},
                                 {"chart-faint", "#5a6470", "#9aa5b1"},
                                 {"chart-grid", "#e3e7eb", "#2b323a"},
                                 {"chart-axis", "#aab2bb", "#4c5662"}};

enum class Theme { kLight, kDark };

std::string color_variables(Theme theme) {
  std::string css;
  const auto add = [&](std::string_view name, std::string_view light, std::string_view dark) {
    css.append("--").append(name).append(":");
    css.append(theme == Theme::kLight ? light : dark).append(";");
  };
  for (const PlainColor& color : kPlain) add(color.name, color.light, color.dark);
  for (const SeriesColor& color : kColors) add(color.style, color.light, color.dark);
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
  std::string css = selector + "{" + color_variables(Theme::kLight) + "}\n" +
                    "@media (prefers-color-scheme:dark){" + selector + "{" +
                    color_variables(Theme::kDark) + "}}\n";
  css += kChartRules;
  for (const SeriesColor& color : kColors) {
    const std::string style(color.style), value = "var(--" + style + ")";
    css += ".line." + style + "{stroke:" + value + ";" + std::string(color.line) + "}";
    css += ".dot." + style + ",.chart .name." + style + "{fill:" + value + "}\n";
  }
  return css;
}

}  // namespace mdk
