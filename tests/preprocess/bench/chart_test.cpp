#include "preprocess/bench/chart.h"

#include <gmock/gmock.h>

#include <cmath>
#include <regex>
#include <set>

#include "common/trace/technique.h"

namespace mdk::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

TEST(Axis, ALinearOneStartsAtZeroAndHasRoundTicks) {
  const Axis axis(Scale::kLinear, AxisEnd::kAtTick, {3, 17.2});
  EXPECT_THAT(axis.ticks(), ElementsAre(0, 5, 10, 15, 20));
  EXPECT_EQ(axis.place(0), 0);
  EXPECT_EQ(axis.place(20), 1);
  const Axis keys(Scale::kLinear, AxisEnd::kAtData, {0, 29});
  EXPECT_THAT(keys.ticks(), ElementsAre(0, 10, 20));
  EXPECT_EQ(keys.place(29), 1);
  EXPECT_THAT(Axis(Scale::kLinear, AxisEnd::kAtData, {1, 2}).ticks(), ElementsAre(0, 1, 2));
}

TEST(Axis, ALogarithmicOneHoldsAllPositiveValues) {
  const Axis axis(Scale::kLog, AxisEnd::kAtTick, {0.01, 0, 30, -5, NAN});
  EXPECT_THAT(axis.ticks(), ElementsAre(0.01, 0.1, 1, 10));
  EXPECT_EQ(axis.place(0), 0);
  EXPECT_GT(axis.place(0.01), 0);
  EXPECT_LT(axis.place(30), 1);
  EXPECT_NEAR(axis.place(1) - axis.place(0.1), axis.place(10) - axis.place(1), 1e-9);
  const Axis narrow(Scale::kLog, AxisEnd::kAtTick, {3, 40});
  EXPECT_THAT(narrow.ticks(), ElementsAre(5, 10, 20));
  EXPECT_THAT(Axis(Scale::kLog, AxisEnd::kAtTick, {11, 45}).ticks(), ElementsAre(15, 20, 30));
}

TEST(Axis, NothingOrOneValueStillMakesAnAxis) {
  for (const Scale scale : {Scale::kLinear, Scale::kLog})
    for (const std::vector<double>& values : {std::vector<double>{}, {0}, {7}, {NAN}}) {
      const Axis axis(scale, AxisEnd::kAtTick, values);
      EXPECT_TRUE(std::isfinite(axis.place(7)));
      EXPECT_GE(axis.ticks().size(), 1u);
    }
}

TEST(Axis, TicksReadWell) {
  EXPECT_EQ(tick_text(0.05), "0.05");
  EXPECT_EQ(tick_text(20), "20");
  EXPECT_EQ(tick_text(5000), "5k");
  EXPECT_EQ(tick_text(1500000), "1.5M");
}

Chart small_chart() {
  Chart chart;
  chart.title = "a < b & c";
  chart.x_label = "key";
  chart.y_label = "ms";
  chart.series = {{"one", "refit-bvh", {{0, 1}, {1, NAN}, {2, 3}}},
                  {"two", "embree", {{0, 2}, {2, 2}}}};
  return chart;
}

TEST(Chart, LeavesOutPointsThatCannotBeShown) {
  Chart chart = small_chart();
  std::string svg = chart_svg(chart, {});
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
  EXPECT_EQ(std::count(svg.begin(), svg.end(), 'L'), 2)
      << "each line goes from point to point once";
  chart.y_scale = Scale::kLog;
  chart.series[1].points[0].y = 0;
  chart.series[1].points[1].y = -1;
  svg = chart_svg(chart, {});
  EXPECT_THAT(svg, Not(HasSubstr("line embree")));
}

TEST(Chart, WritesTextThatIsSafe) {
  EXPECT_THAT(chart_svg(small_chart(), {}), HasSubstr("a &lt; b &amp; c"));
  EXPECT_EQ(escaped("\"<&>\x01"), "&quot;&lt;&amp;&gt;");
}

TEST(Chart, NamesAtTheEndsDoNotOverlapAndStayInside) {
  Chart chart = small_chart();
  chart.labels = Labels::kAtEnd;
  chart.series.clear();
  for (int i = 0; i < 9; ++i)
    chart.series.push_back({"series " + std::to_string(i),
                            numbered_style(static_cast<std::size_t>(i)),
                            {{0, 1}, {10, 0.001 * i}}});
  chart.series.push_back({"high", "n9", {{0, 1}, {10, 1}}});
  const ChartSize size{400, 260};
  const std::string svg = chart_svg(chart, size);
  const std::regex name("y=\"([0-9.]+)\" class=\"name");
  std::set<double> heights;
  for (std::sregex_iterator i(svg.begin(), svg.end(), name), end; i != end; ++i)
    heights.insert(std::stod((*i)[1]));
  ASSERT_EQ(heights.size(), 10u);
  double before = -100;
  for (const double y : heights) {
    EXPECT_GE(y - before, 13.9);
    before = y;
  }
  EXPECT_LE(before, size.height);
}

TEST(Chart, EveryTechniqueHasALookOfItsOwnInLightAndDark) {
  const std::string css = chart_style(":root");
  std::set<std::string> looks;
  std::size_t count = 0;
  for (const TechniqueInfo& technique : technique_table()) {
    const std::string style = technique_style(technique.id);
    EXPECT_EQ(style, technique.id);
    std::smatch color, line;
    ASSERT_TRUE(std::regex_search(css, color, std::regex("--" + style + ":(#[0-9a-f]{6})")));
    ASSERT_TRUE(
        std::regex_search(css, line, std::regex("\\.line\\." + style + "\\{[^;]*;([^}]*)\\}")));
    looks.insert(color[1].str() + line[1].str());
    ++count;
  }
  EXPECT_EQ(looks.size(), count);
  EXPECT_THAT(css, HasSubstr("prefers-color-scheme:dark"));
}

}  // namespace
}  // namespace mdk::test
