// Table 1 and Figures 7 and 8 of GFW06, with our figures in place of theirs.
#include <algorithm>

#include "preprocess/cli/bench/sections.h"
#include "preprocess/cli/number_text.h"

namespace mdk {
namespace {

/// GFW06 Table 1.
struct PaperRow {
  const char* scene;
  const char* triangles;
  const char* steps_ratio;
  const char* tests_ratio;
  const char* fps_ratio;
  const char* fuzzy_fps;
};
constexpr PaperRow kPaper[] = {{"ben", "78,029", "1.54", "1.9", "1.94", "10.77"},
                               {"chicken", "5,664", "1.80", "6.2", "2.61", "15.03"},
                               {"cow", "5,804", "1.49", "4.0", "1.53", "12.49"},
                               {"dolphin", "12,377", "1.91", "1.59", "1.16", "19.31"},
                               {"hand", "15,855", "1.76", "1.15", "1.64", "10.94"}};

const PaperRow* paper_row(const std::string& model) {
  for (const PaperRow& row : kPaper)
    if (model == row.scene) return &row;
  return nullptr;
}

std::string ratio_text(double a, double b) { return b > 0 ? fixed_text(a / b, 2) : "–"; }

double fps_of(const TechniqueBench& technique) {
  const double ms = technique.time_to_image_ms().median;
  return ms > 0 ? 1000 / ms : 0;
}

std::vector<std::string> table1_row(const ModelBench& model, const TechniqueBench& fixed,
                                    const TechniqueBench& fuzzy) {
  const PaperRow* paper = paper_row(model.name());
  const auto theirs = [&](const char* PaperRow::*field) {
    return paper == nullptr ? std::string("–") : std::string(paper->*field);
  };
  const WorkPerRay a = fixed.work(), b = fuzzy.work();
  return {model.name(),
          grouped_text(model.triangles),
          std::to_string(model.keys),
          std::to_string(model.clusters),
          fixed_text(a.node_visits, 3),
          fixed_text(b.node_visits, 3),
          "**" + ratio_text(b.node_visits, a.node_visits) + "**",
          theirs(&PaperRow::steps_ratio),
          fixed_text(a.triangle_tests, 2),
          fixed_text(b.triangle_tests, 2),
          "**" + ratio_text(b.triangle_tests, a.triangle_tests) + "**",
          theirs(&PaperRow::tests_ratio),
          fixed_text(fps_of(fixed), 1),
          fixed_text(fps_of(fuzzy), 1),
          "**" + ratio_text(fps_of(fixed), fps_of(fuzzy)) + "**",
          theirs(&PaperRow::fps_ratio)};
}

constexpr double kLeastShare = 1e-3;

/// Each in shares of its value with one cluster.
Chart growth_chart(const ModelBench& model) {
  Chart chart;
  chart.title = model.name();
  chart.x_label = "clusters";
  chart.y_label = "share of one cluster's";
  chart.y_scale = Scale::kLog;
  chart.marks = Marks::kDots;
  ChartSeries residual{"residual motion (RMS)", numbered_style(1), {}};
  ChartSeries area{"area of the fuzzy boxes", numbered_style(0), {}};
  ChartSeries cost{"expected work of a ray", numbered_style(2), {}};
  const std::vector<GrowthRow>& rows = model.bake->growth;
  const GrowthRow& first = rows.front();
  const auto add = [](ChartSeries& series, double x, double value, double unit) {
    if (unit > 0) series.points.push_back({x, std::max(value / unit, kLeastShare)});
  };
  for (const GrowthRow& row : rows) {
    add(residual, row.clusters, row.residual_rms, first.residual_rms);
    add(area, row.clusters, row.fuzzy_area, first.fuzzy_area);
    add(cost, row.clusters, row.sah_cost, first.sah_cost);
  }
  chart.series = {residual, area, cost};
  return chart;
}

/// Frames per second over the course of every animation.
Chart frame_rate_chart(const BenchRun& run, const std::string& id) {
  Chart chart;
  chart.title = id;
  chart.x_label = "course of the animation, %";
  chart.y_label = "frames per second";
  chart.labels = Labels::kAtEnd;
  std::size_t number = 0;
  for (const ModelBench* model : whole_models(run)) {
    const std::size_t style = number++;
    const TechniqueBench* technique = model->find(id);
    if (technique == nullptr || technique->frames.size() < 2 || model->keys < 2) continue;
    ChartSeries series{model->name(), numbered_style(style), {}};
    for (const BenchFrame& frame : technique->frames)
      series.points.push_back({100.0 * frame.key / (model->keys - 1),
                               frame.time_to_image_ms() > 0 ? 1000 / frame.time_to_image_ms() : 0});
    chart.series.push_back(std::move(series));
  }
  return chart;
}

}  // namespace

Section gfw06_table1_section(const BenchRun& run) {
  Section section{"gfw06-table-1", "Fuzzy kd-tree against static kd-trees (GFW06 Table 1)", {}};
  Table table;
  table.head = {"model",        "triangles",   "keys",  "clusters",
                "steps static", "steps fuzzy", "ratio", "GFW06",
                "tests static", "tests fuzzy", "ratio", "GFW06",
                "fps static",   "fps fuzzy",   "ratio", "GFW06"};
  for (const ModelBench& model : run.models) {
    const TechniqueBench* fixed = model.find("static-kdtree");
    const TechniqueBench* fuzzy = model.find("fuzzy-kdtree");
    if (fixed != nullptr && fuzzy != nullptr)
      table.rows.push_back(table1_row(model, *fixed, *fuzzy));
  }
  if (table.rows.empty()) {
    section.blocks.push_back(
        Paragraph{"Needs `static-kdtree` and `fuzzy-kdtree` measured on one model."});
    return section;
  }
  section.blocks.push_back(Paragraph{
      "One kd-tree over fuzzy boxes that hold at all times (`fuzzy-kdtree`) beside a kd-tree built "
      "ahead for every single key (`static-kdtree`): traversal steps and triangle tests per ray, "
      "amortised over the rays of a tile, and frames per second. Ratios are what the one tree "
      "costs: fuzzy / static for work, static / fuzzy for frames per second. GFW06's ratios stand "
      "beside those of samples of the same kind."});
  section.blocks.push_back(std::move(table));
  return section;
}

Section gfw06_figure7_section(const BenchRun& run) {
  Section section{"gfw06-figure-7", "While clusters are added (GFW06 Figure 7)", {}};
  Figure figure;
  figure.id = "gfw06-figure-7";
  figure.caption =
      "Residual motion, summed area of the fuzzy boxes, and the expected work of a ray (area, and "
      "a "
      "price for every cluster met), as the bake saw them at each stage; each relative to one "
      "cluster, and drawn at 0.001 where it is less.";
  for (const ModelBench* model : whole_models(run))
    if (model->bake && model->bake->growth.size() > 1)
      figure.charts.push_back(growth_chart(*model));
  if (figure.charts.empty()) {
    section.blocks.push_back(Paragraph{
        "No bake report with more than one stage stood beside the files: bake with `--report "
        "NAME.json` beside `NAME.mdk`."});
  } else {
    section.blocks.push_back(std::move(figure));
  }
  return section;
}

Section gfw06_figure8_section(const BenchRun& run) {
  Section section{"gfw06-figure-8", "Frame rate over the animation (GFW06 Figure 8)", {}};
  Figure figure;
  figure.id = "gfw06-figure-8";
  figure.has_legend = false;
  figure.caption = "Frames per second over the course of each animation, one line per model.";
  for (const char* id : {"fuzzy-kdtree", "fuzzy-bvh"}) {
    Chart chart = frame_rate_chart(run, id);
    if (!chart.series.empty()) figure.charts.push_back(std::move(chart));
  }
  if (figure.charts.empty()) {
    section.blocks.push_back(
        Paragraph{"Needs `fuzzy-kdtree` or `fuzzy-bvh` measured at two keys or more."});
  } else {
    section.blocks.push_back(std::move(figure));
  }
  return section;
}

}  // namespace mdk
