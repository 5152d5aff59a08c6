// Tables and figures of GFW06, with our figures in place of theirs.
#include <algorithm>

#include "common/base/text.h"
#include "preprocess/bench/report.h"

namespace mdk {
namespace {

/// GFW06 Table 1: traversal steps of a picture, candidates in leaves per ray, frames per second.
struct PaperRow {
  const char *scene, *triangles, *frames, *clusters;
  const char *steps_static, *steps_fuzzy, *steps_ratio;
  const char *leaf_static, *leaf_fuzzy, *leaf_ratio;
  const char *fps_static, *fps_fuzzy, *fps_ratio;
};
const std::vector<PaperRow>& paper_rows() {
  static const std::vector<PaperRow> rows = {
      {"ben", "78,029", "30", "20", "722,068", "1,111,808", "1.54", "1.2", "2.28", "1.9", "20.98",
       "10.77", "1.94"},
      {"chicken", "5,664", "400", "21", "210,458", "379,466", "1.80", "0.80", "4.96", "6.2",
       "39.24", "15.03", "2.61"},
      {"cow", "5,804", "204", "20", "634,173", "946,558", "1.49", "0.92", "3.68", "4.0", "19.21",
       "12.49", "1.53"},
      {"dolphin", "12,377", "101", "16", "534,156", "1,020,469", "1.91", "1.08", "1.72", "1.59",
       "22.56", "19.31", "1.16"},
      {"hand", "15,855", "30", "21", "1,330,951", "2,307,758", "1.76", "1.28", "1.48", "1.15",
       "17.98", "10.94", "1.64"}};
  return rows;
}

/// A model with a fuzzy tree and static ones measured.
struct KdTrees {
  const ModelBench& model;
  const TechniqueBench &fixed, &fuzzy;
  WorkPerRay fixed_work = fixed.work(), fuzzy_work = fuzzy.work();

  /// What the paper has for the scene the model is named after: "cow", "real-cow", "cow-paper".
  std::string paper(const char* PaperRow::*ratio) const {
    for (const PaperRow& row : paper_rows())
      for (const char* before : {"", "real-"})
        if (base_name(model.name()) == std::string(before) + row.scene) return row.*ratio;
    return "–";
  }
  static std::string leaf_text(const TechniqueBench& technique) {
    return technique.has_leaf_counts() ? fixed_text(technique.work().leaf_triangles, 3) : "–";
  }
  std::string leaf_ratio() const {
    const bool are_counted = fixed.has_leaf_counts() && fuzzy.has_leaf_counts();
    return are_counted ? strong_ratio(fuzzy_work.leaf_triangles, fixed_work.leaf_triangles) : "–";
  }
  double trace_ms(const TechniqueBench& technique) const {
    return technique.median_ms(&BenchFrame::trace_ms);
  }
};

/// With which constants the trees were built, and whether alike.
std::string constants_sentence(const std::vector<KdTrees>& rows) {
  std::vector<double> ratios;
  for (const KdTrees& row : rows)
    for (const TechniqueBench* technique : {&row.fixed, &row.fuzzy})
      ratios.push_back(technique->kd_cost_ratio);
  std::ranges::sort(ratios);
  ratios.erase(std::unique(ratios.begin(), ratios.end()), ratios.end());
  if (ratios.size() == 1 && ratios[0] > 0)
    return "All trees, fuzzy and static, are built by the same surface area heuristic, with a "
           "triangle test at " +
           fixed_text(ratios[0], 2) + " of a traversal step.";
  if (ratios.empty() || ratios.back() == 0)
    return "**These ratios do not compare like with like**: the results are of an older program, "
           "which built static trees with a triangle test at 1.5 traversal steps and fuzzy trees "
           "with one at 0.4, so that static trees take more steps and have fewer candidates than "
           "they would with equal constants.";
  return "**These ratios do not compare like with like**: not all trees were built with the same "
         "constants.";
}

Section gfw06_table1(const BenchRun& run) {
  std::vector<KdTrees> rows;
  for (const ModelBench& model : run.models) {
    const TechniqueBench* fixed = model.find("static-kdtree");
    const TechniqueBench* fuzzy = model.find("fuzzy-kdtree");
    if (fixed != nullptr && fuzzy != nullptr && variant_of(model.name()) != "level")
      rows.push_back({model, *fixed, *fuzzy});
  }
  Table table = table_of<KdTrees>(
      "One kd-tree over fuzzy boxes that hold at all times (`fuzzy-kdtree`) beside a kd-tree built "
      "ahead for every single key (`static-kdtree`). Per ray, amortised over the rays of a tile: "
      "traversal steps; candidates, the triangles of the leaves a tile enters, before any is "
      "culled and each once for a tile, which is what GFW06 counts; and tests, the ray-triangle "
      "pairs still evaluated after culling by the triangles' bounds and depths, which the paper "
      "does not have. Ratios are what the one tree costs: fuzzy / static for work and trace time, "
      "static / fuzzy for frames per second. GFW06's ratios stand beside those of models named as "
      "its scenes; `real-cow` is its COW, the samples are other meshes of the same kind. "
      "Models named `-paper` are baked by the paper's method with the paper's number of clusters, "
      "boxes bounded at keys alone. " +
          constants_sentence(rows),
      rows,
      {{"model", [](auto& r) { return r.model.name(); }},
       {"triangles", [](auto& r) { return grouped_text(r.model.triangles); }},
       {"keys", [](auto& r) { return std::to_string(r.model.keys); }},
       {"clusters", [](auto& r) { return std::to_string(r.model.clusters); }},
       {"steps static", [](auto& r) { return fixed_text(r.fixed_work.node_visits, 3); }},
       {"steps fuzzy", [](auto& r) { return fixed_text(r.fuzzy_work.node_visits, 3); }},
       {"ratio",
        [](auto& r) { return strong_ratio(r.fuzzy_work.node_visits, r.fixed_work.node_visits); }},
       {"GFW06", [](auto& r) { return r.paper(&PaperRow::steps_ratio); }},
       {"candidates static", [](auto& r) { return KdTrees::leaf_text(r.fixed); }},
       {"candidates fuzzy", [](auto& r) { return KdTrees::leaf_text(r.fuzzy); }},
       {"ratio", [](auto& r) { return r.leaf_ratio(); }},
       {"GFW06", [](auto& r) { return r.paper(&PaperRow::leaf_ratio); }},
       {"tests static", [](auto& r) { return fixed_text(r.fixed_work.triangle_tests, 2); }},
       {"tests fuzzy", [](auto& r) { return fixed_text(r.fuzzy_work.triangle_tests, 2); }},
       {"ratio",
        [](auto& r) {
          return strong_ratio(r.fuzzy_work.triangle_tests, r.fixed_work.triangle_tests);
        }},
       {"trace static", [](auto& r) { return fixed_text(r.trace_ms(r.fixed), 2); }},
       {"trace fuzzy", [](auto& r) { return fixed_text(r.trace_ms(r.fuzzy), 2); }},
       {"ratio", [](auto& r) { return strong_ratio(r.trace_ms(r.fuzzy), r.trace_ms(r.fixed)); }},
       {"fps static", [](auto& r) { return fixed_text(r.fixed.fps(), 1); }},
       {"fps fuzzy", [](auto& r) { return fixed_text(r.fuzzy.fps(), 1); }},
       {"ratio", [](auto& r) { return strong_ratio(r.fixed.fps(), r.fuzzy.fps()); }},
       {"GFW06", [](auto& r) { return r.paper(&PaperRow::fps_ratio); }}});
  const auto cell = [](const char* PaperRow::*figure) {
    return [=](const PaperRow& row) -> std::string { return row.*figure; };
  };
  Table paper = table_of<PaperRow>(
      "GFW06's own figures (1024 x 1024, one Opteron at 2.8 GHz): traversal steps of a picture, "
      "candidates per ray, averages over the animation.",
      paper_rows(),
      {{"scene", cell(&PaperRow::scene)},
       {"triangles", cell(&PaperRow::triangles)},
       {"keys", cell(&PaperRow::frames)},
       {"clusters", cell(&PaperRow::clusters)},
       {"steps static", cell(&PaperRow::steps_static)},
       {"steps fuzzy", cell(&PaperRow::steps_fuzzy)},
       {"ratio", cell(&PaperRow::steps_ratio)},
       {"candidates static", cell(&PaperRow::leaf_static)},
       {"candidates fuzzy", cell(&PaperRow::leaf_fuzzy)},
       {"ratio", cell(&PaperRow::leaf_ratio)},
       {"fps static", cell(&PaperRow::fps_static)},
       {"fps fuzzy", cell(&PaperRow::fps_fuzzy)},
       {"ratio", cell(&PaperRow::fps_ratio)}});
  return {"gfw06-table-1",
          "Fuzzy kd-tree against static kd-trees (GFW06 Table 1)",
          {or_needs(std::move(table),
                    "Needs `static-kdtree` and `fuzzy-kdtree` measured on one model."),
           std::move(paper)}};
}

/// One pose, cut into clusters that do not move: what the second level costs where nothing else is
/// different.
Section gfw06_second_level(const BenchRun& run) {
  std::vector<KdTrees> rows;
  for (const ModelBench& model : run.models) {
    const TechniqueBench* fixed = model.find("static-kdtree");
    const TechniqueBench* fuzzy = model.find("fuzzy-kdtree");
    if (fixed != nullptr && fuzzy != nullptr && variant_of(model.name()) == "level")
      rows.push_back({model, *fixed, *fuzzy});
  }
  Table table = table_of<KdTrees>(
      "A model of a single pose, cut into clusters, so that no fuzzy box is larger than its "
      "triangle: one kd-tree over all triangles (`static-kdtree`) beside one for each cluster "
      "under a top level (`fuzzy-kdtree`). GFW06 puts the second level at about 30 % of the frame "
      "rate, for mapping rays; a tile here maps one pinhole for each cluster.",
      rows,
      {{"model", [](auto& r) { return r.model.name(); }},
       {"triangles", [](auto& r) { return grouped_text(r.model.triangles); }},
       {"clusters", [](auto& r) { return std::to_string(r.model.clusters); }},
       {"steps, two levels / one",
        [](auto& r) { return strong_ratio(r.fuzzy_work.node_visits, r.fixed_work.node_visits); }},
       {"candidates", [](auto& r) { return r.leaf_ratio(); }},
       {"trace one level", [](auto& r) { return fixed_text(r.trace_ms(r.fixed), 2); }},
       {"trace two levels", [](auto& r) { return fixed_text(r.trace_ms(r.fuzzy), 2); }},
       {"ratio", [](auto& r) { return strong_ratio(r.trace_ms(r.fuzzy), r.trace_ms(r.fixed)); }},
       {"frames per second, one / two levels",
        [](auto& r) { return strong_ratio(r.fixed.fps(), r.fuzzy.fps()); }}});
  return {"gfw06-second-level",
          "What a second level costs alone (GFW06 §5)",
          {or_needs(std::move(table),
                    "Needs `static-kdtree` and `fuzzy-kdtree` measured on a model of one key, "
                    "baked with `--clusters N` and named `NAME-level`.")}};
}

/// A figure of the decomposition as a share of what it is with one cluster.
ChartSeries growth_series(const std::vector<GrowthStep>& steps, const char* label,
                          std::size_t style, double GrowthStep::*figure) {
  constexpr double kMinShare = 1e-3;
  ChartSeries series{label, numbered_style(style), {}};
  const double unit = steps.front().*figure;
  for (const GrowthStep& step : steps)
    if (unit > 0)
      series.points.push_back(
          {static_cast<double>(step.clusters), std::max(step.*figure / unit, kMinShare)});
  return series;
}

Section gfw06_figure7(const BenchRun& run) {
  const auto chart_of = [](const ModelBench& model) {
    Chart chart{.title = model.name(),
                .x_label = "clusters",
                .y_label = "share of one cluster's",
                .y_scale = Scale::kLog,
                .marks = Marks::kDots};
    if (!model.bake || model.bake->growth.size() < 2) return chart;
    const std::vector<GrowthStep>& steps = model.bake->growth;
    chart.series = {growth_series(steps, "residual motion (RMS)", 1, &GrowthStep::residual_rms),
                    growth_series(steps, "area of the fuzzy boxes", 0, &GrowthStep::fuzzy_area),
                    growth_series(steps, "expected work of a ray", 2, &GrowthStep::sah_cost)};
    return chart;
  };
  std::vector<Chart> charts = charts_of_models(run, chart_of);
  for (const ModelBench& model : run.models)
    if (variant_of(model.name()) == "paper")
      if (Chart chart = chart_of(model); !chart.series.empty()) charts.push_back(std::move(chart));
  return figure_section(
      {.id = "gfw06-figure-7",
       .caption = "Residual motion, summed area of the fuzzy boxes, and the expected work of a ray "
                  "(area, and a fixed cost for every cluster entered), as the bake saw them at "
                  "each stage; "
                  "each relative to one cluster, and drawn at 0.001 where it is less. Charts of "
                  "`-paper` models show the paper's own method, one cluster at a time.",
       .charts = std::move(charts)},
      "While clusters are added (GFW06 Figure 7)",
      "No bake report with more than one stage stood beside the files: bake with `--report "
      "NAME.json` beside `NAME.mdk`.");
}

Chart frame_rate_chart(const BenchRun& run, const char* id) {
  Chart chart{.title = id,
              .x_label = "course of the animation, %",
              .y_label = "frames per second",
              .labels = Labels::kAtEnd};
  const std::vector<const ModelBench*> models = whole_models(run);
  for (std::size_t m = 0; m < models.size(); ++m) {
    const TechniqueBench* technique = models[m]->find(id);
    const std::uint32_t keys = models[m]->keys;
    if (technique == nullptr || technique->frames.size() < 2 || keys < 2) continue;
    ChartSeries series{models[m]->name(), numbered_style(m), {}};
    for (const BenchFrame& frame : technique->frames)
      series.points.push_back(
          {100.0 * frame.key / (keys - 1), per_second(frame.time_to_image_ms())});
    chart.series.push_back(std::move(series));
  }
  return chart;
}

Section gfw06_figure8(const BenchRun& run) {
  Figure figure{
      .id = "gfw06-figure-8",
      .caption = "Frames per second over the course of each animation, one line per model.",
      .has_legend = false};
  for (const char* id : {"fuzzy-kdtree", "fuzzy-bvh"}) {
    Chart chart = frame_rate_chart(run, id);
    if (!chart.series.empty()) figure.charts.push_back(std::move(chart));
  }
  return figure_section(std::move(figure), "Frame rate over the animation (GFW06 Figure 8)",
                        "Needs `fuzzy-kdtree` or `fuzzy-bvh` measured at two keys or more.");
}

}  // namespace

std::vector<Section> gfw06_sections(const BenchRun& run) {
  return {gfw06_table1(run), gfw06_second_level(run), gfw06_figure7(run), gfw06_figure8(run)};
}

}  // namespace mdk
